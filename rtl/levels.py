"""The longest logic path of a netlist for Virtex-II: how many levels, and between which signals.

A level is a LUT, a multiplier without a register, or a carry chain, however long that is: a carry
takes a tenth of a LUT's time. Levels are not nanoseconds, but no placement is needed to count them,
and what a stage of the pipeline grows by shows at once.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from graphlib import TopologicalSorter
from typing import NamedTuple

__all__ = ["longest_path"]

LUTS = ("LUT1", "LUT2", "LUT3", "LUT4")
CARRIES = ("MUXCY", "XORCY")
MULTIPLIER = "MULT18X18"
FREE = ("INV", "BUFG")
"""An inverter is part of the pin that it leads to, as where LUTs are counted."""

MEMORIES = {"RAM16X1S": "A", "RAM16X1D": "DPRA", "RAM32X1S": "A"}
"""LUTs as memory, read at once and written by the clock: how the pins of the read address begin."""

LOGIC = (*LUTS, *CARRIES, MULTIPLIER, *FREE, *MEMORIES)
PORTS = ("IBUF", "OBUF")
REGISTERS = ("FD", "RAMB", "MULT18X18S", *MEMORIES)
"""How the names of what has a clock begin."""

CONTROLS = {"CE": "clock enable of ", "R": "reset of ", "S": "set of "}
"""A flip-flop's inputs that are not its data."""


class _Arrival(NamedTuple):
    """The longest way to a bit: its levels and cells, the cell that drives it, and from which bit.

    Where two are equally long in levels, the one with more cells is the longer.
    """

    levels: int
    cells: int
    driver: str
    source: int | None


def longest_path(module: dict) -> dict:
    """Return the longest path from a register or memory to another, ports left out.

    Parameters
    ----------
    module
        A flat module as Yosys writes it in JSON, made of Virtex-II's cells.

    Returns
    -------
    dict
        ``levels``; ``luts``, ``carries`` and ``multipliers`` on the way (cells, so that a chain of
        ten carries counts ten); ``start`` and ``end``, by the names of signals.

    Raises
    ------
    RuntimeError
        If there is a cell that is not known, or no path at all.
    """
    cells = {
        name: cell for name, cell in module["cells"].items() if cell["type"][0] != "$"
    }  # what is left are notes of Yosys
    arrivals = _arrivals(cells)
    ends = [
        (arrivals[bit].levels, arrivals[bit].cells, name, pin, bit)
        for name, cell in cells.items()
        if cell["type"].startswith(REGISTERS)
        for pin, bit in _inputs(cell)
        if bit in arrivals
    ]
    if not ends:
        raise RuntimeError("there is no path from a register to a register")
    # Of equal ones the first in the alphabet, so that the same netlist gives the same answer.
    levels, _, name, pin, bit = min(ends, key=lambda end: (-end[0], -end[1], *end[2:]))
    way = []
    arrival = arrivals[bit]
    while arrival.source is not None:
        way.append(cells[arrival.driver]["type"])
        arrival = arrivals[arrival.source]
    found = Counter(way)
    names = _signal_names(module)
    return {
        "levels": levels,
        "luts": sum(found[kind] for kind in (*LUTS, *MEMORIES)),
        "carries": sum(found[kind] for kind in CARRIES),
        "multipliers": found[MULTIPLIER],
        "start": _register_name(cells, arrival.driver, names),
        "end": CONTROLS.get(pin, "") + _register_name(cells, name, names, pin),
    }


def _arrivals(cells: dict) -> dict[int, _Arrival]:
    """Return the longest way to each bit that a register leads to."""
    drivers = {}
    arrivals = {}
    for name, cell in cells.items():
        for bit in _bits(cell, "output"):
            drivers[bit] = name
            if cell["type"].startswith(REGISTERS):
                arrivals[bit] = _Arrival(0, 0, name, None)
            elif cell["type"] not in (*LOGIC, *PORTS):  # a memory made of LUTs is both
                raise RuntimeError(f"no levels are known of the cell {cell['type']}")
    logic = {name: cell for name, cell in cells.items() if cell["type"] in LOGIC}
    before = {
        name: {drivers[bit] for _, bit in _through(cell) if drivers.get(bit) in logic}
        for name, cell in logic.items()
    }
    for name in TopologicalSorter(before).static_order():
        ways = [
            _Arrival(
                arrivals[bit].levels + _levels(logic[name], pin, cells[drivers[bit]]),
                arrivals[bit].cells + 1,
                name,
                bit,
            )
            for pin, bit in _through(logic[name])
            if bit in arrivals
        ]
        if ways:
            longest = max(ways, key=lambda way: way[:2])
            arrivals |= dict.fromkeys(_bits(logic[name], "output"), longest)
    return arrivals


def _levels(cell: dict, pin: str, driver: dict) -> int:
    """Return what a cell adds to the levels of a way through one of its pins."""
    along = pin == "CI" and driver["type"] == "MUXCY"
    return int(cell["type"] not in FREE and not along)


def _through(cell: dict) -> Iterator[tuple[str, int]]:
    """Yield the pins of a cell that its output follows at once, with their bits."""
    address = MEMORIES.get(cell["type"], "")
    return ((pin, bit) for pin, bit in _inputs(cell) if pin.startswith(address))


def _inputs(cell: dict) -> Iterator[tuple[str, int]]:
    """Yield the pins of a cell that take a signal, with its bit; clocks are no signals here."""
    for pin, direction in cell["port_directions"].items():
        if direction == "input" and pin not in ("C", "CLKA", "CLKB", "WCLK"):
            for bit in cell["connections"][pin]:
                if isinstance(bit, int):  # else a constant
                    yield pin, bit


def _bits(cell: dict, direction: str) -> list[int]:
    """Return the bits at a cell's inputs or outputs."""
    ports = cell["port_directions"]
    return [bit for pin in ports if ports[pin] == direction for bit in cell["connections"][pin]]


def _signal_names(module: dict) -> dict[int, str]:
    """Return a name of each bit: of those in the source, one that says where it is."""
    best: dict[int, tuple] = {}
    for name, net in module["netnames"].items():
        # Amaranth numbers the further names of a signal with $; names that Yosys makes are hidden.
        rank = (net["hide_name"], "$" in name, "." not in name, len(name), name)
        for place, bit in enumerate(net["bits"]):
            if bit not in best or rank < best[bit][0]:
                index = f"[{place + net.get('offset', 0)}]" if len(net["bits"]) > 1 else ""
                best[bit] = rank, name + index
    return {bit: name for bit, (_, name) in best.items()}


def _register_name(cells: dict, name: str, names: dict[int, str], pin: str = "") -> str:
    """Return what to call a register: its output's signal, or a memory's name with the pin."""
    cell = cells[name]
    if cell["type"].startswith("FD"):
        return names[cell["connections"]["Q"][0]]
    return f"{name} {pin}".rstrip()
