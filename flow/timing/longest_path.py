"""The longest path between the registers of a Virtex-II netlist, by a measure of choice.

``logic_levels`` counts cells, and ``virtex2_delays`` counts nanoseconds.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

__all__ = ["LUT_MEMORIES", "REGISTERS", "Path", "Step", "find_longest", "pins", "signal_names"]

LUT_MEMORIES = ("RAM16X1", "RAM32X1", "RAM64X1", "RAM128X1")
"""Prefixes of distributed RAM. It is written at the clock edge, and read without a clock."""

REGISTERS = ("FD", "RAMB16", "MULT18X18S", *LUT_MEMORIES)
"""Prefixes of cells with a clock."""

READ_BY = {"O": "A", "SPO": "A", "DPO": "DPRA"}
"""Prefix of the address pins for each output of a distributed RAM."""

LOGIC = ("LUT1", "LUT2", "LUT3", "LUT4", "MUXF5", "MUXF6", "MUXF7", "MUXF8")
LOGIC += ("MUXCY", "XORCY", "MULT18X18", "INV")
PADS = ("IBUF", "OBUF", "BUFG", "BUFGP")
CLOCKS = ("C", "CLKA", "CLKB", "WCLK")


class Step(NamedTuple):
    """A wire of a path, from a cell of kind ``source``, and the cell that it drives.

    ``out`` is the bit of that cell's output through which the path goes on.
    """

    bit: int
    fan_out: int
    source: str
    cell: str
    kind: str
    pin: str
    out: int = 0


class Path(NamedTuple):
    """A path's length, the register where it starts, and its steps into another register."""

    total: float
    start: str
    steps: list[Step]


def find_longest(
    module: dict,
    *,
    start: Callable[[str], float],
    through: Callable[[Step], float],
    end: Callable[[Step], float],
) -> Path:
    """Return the longest path from a register or memory to another, without ports.

    Of paths of equal length it is that with the alphabetically first end, so the same netlist gives
    the same result.

    Parameters
    ----------
    module
        A flat module as Yosys writes it in JSON after ``synth_xilinx -family xc2v -ise -flatten``.
    start
        Function of a kind of register: length at the start of a path.
    through
        Function of a step: length of its wire and of the cell that it drives.
    end
        Function of a step into a register: its length.

    Raises
    ------
    RuntimeError
        If a cell is not known, there is a combinational loop, or no path joins two registers.
    """
    # Cells with a $ are comments of Yosys.
    cells = {n: cell for n, cell in module["cells"].items() if cell["type"][0] != "$"}
    for kind in {cell["type"] for cell in cells.values()}:
        if not kind.startswith(REGISTERS) and kind not in (*LOGIC, *PADS):
            raise RuntimeError(f"the cell {kind} is not known")
    drivers = {bit: name for name, cell in cells.items() for *_, bit in pins(cell, "output")}
    fan_out = Counter(bit for cell in cells.values() for *_, bit in pins(cell, "input"))
    registers = {name: c for name, c in cells.items() if c["type"].startswith(REGISTERS)}
    arrivals: dict[int, tuple[float, Step | None]] = {
        bit: (start(cell["type"]), None)
        for cell in registers.values()
        for *_, bit in pins(cell, "output")
    }

    def steps(name: str, output: str = "", out: int = 0) -> Iterator[tuple[float, Step]]:
        """Yield the steps into a cell, each with the length of the path before it."""
        kind = cells[name]["type"]
        for pin, _, bit in _causes(cells[name], output):
            if bit in arrivals:
                source = cells[drivers[bit]]["type"]
                yield arrivals[bit][0], Step(bit, fan_out[bit], source, name, kind, pin, out)

    for name in _sorted(cells, drivers):
        for output, out, driven in pins(cells[name], "output"):
            ways = [(before + through(step), step) for before, step in steps(name, output, out)]
            best = max(ways, key=lambda way: way[0], default=None)
            if best and (driven not in arrivals or best[0] > arrivals[driven][0]):
                arrivals[driven] = best

    ends = [(before + end(step), step) for name in registers for before, step in steps(name)]
    if not ends:
        raise RuntimeError("there is no path from a register to a register")
    total, last = min(ends, key=lambda way: (-way[0], way[1].cell, way[1].pin, way[1].bit))
    way = [last]
    while (before := arrivals[way[-1].bit][1]) is not None:
        way.append(before)
    return Path(total, drivers[way[-1].bit], way[::-1])


def pins(cell: dict, direction: str) -> Iterator[tuple[str, int, int]]:
    """Yield the pins of one direction: name, index and bit, without constants."""
    for pin, way in cell["port_directions"].items():
        if way == direction:
            for place, bit in enumerate(cell["connections"][pin]):
                if isinstance(bit, int):
                    yield pin, place, bit


def signal_names(module: dict) -> dict[int, str]:
    """Return a name for each bit that has one in the source; the most telling one of several."""
    best: dict[int, tuple] = {}
    for name, net in module["netnames"].items():
        if net["hide_name"]:
            continue  # made by Yosys
        # An unnamed signal is called _7_, see flow/tidy_names.py.
        rank = (
            re.search(r"\b_\d+_$", name) is not None or "$" in name,
            "." not in name,
            len(name),
            name,
        )
        for place, bit in enumerate(net["bits"]):
            if bit not in best or rank < best[bit][0]:
                index = f"[{place + net.get('offset', 0)}]" if len(net["bits"]) > 1 else ""
                best[bit] = rank, name + index
    return {bit: name for bit, (_, name) in best.items()}


def _sorted(cells: dict, drivers: dict[int, str]) -> Iterator[str]:
    """Yield the cells of logic in topological order."""
    before = {
        name: {
            drivers[bit]
            for output, *_ in pins(cell, "output")
            for *_, bit in _causes(cell, output)
            if bit in drivers
        }
        for name, cell in cells.items()
        if cell["type"] in LOGIC or cell["type"].startswith(LUT_MEMORIES)
    }
    try:
        yield from (name for name in TopologicalSorter(before).static_order() if name in before)
    except CycleError as error:
        raise RuntimeError(f"the netlist has a combinational loop: {error.args[1]}") from None


def _causes(cell: dict, output: str) -> Iterator[tuple[str, int, int]]:
    """Yield the inputs of an output's combinational logic; without an output, all but clocks."""
    address = READ_BY[output] if output and cell["type"].startswith(LUT_MEMORIES) else ""
    for pin, place, bit in pins(cell, "input"):
        if pin.startswith(address) and pin not in CLOCKS:
            yield pin, place, bit
