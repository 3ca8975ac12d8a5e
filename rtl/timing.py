"""How fast a netlist might run in a Virtex-II: its longest path with the cells' published delays.

No place is known of any cell, so what the wires take is a guess by fan-out, and the result is an
**estimate**: the vendor's tools alone can tell (``docs/ise.md``).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

__all__ = ["SOURCE", "estimate_timing", "net_delay"]

SOURCE = "Virtex-II -4, DS031 module 3, entered from memory; nets: 0.6 ns + 0.2 ns log2(fan-out)"
"""Where the delays come from. The data sheet was not at hand when they were written down: compare
them with its tables of CLB, block RAM and multiplier switching characteristics."""

CLOCK_TO_OUT = {"FD": 0.57, "RAMB16": 2.65, "RAM16X1": 1.4, "RAM32X1": 1.7, "MULT18X18S": 3.0}
"""ns from the clock's edge to an output: T_CKO, T_BCKO, T_SHCKO16, T_SHCKO32, T_MULTCK."""

SETUP = {"FD": 0.37, "RAMB16": 0.36, "RAM16X1": 0.6, "RAM32X1": 0.6, "MULT18X18S": 2.7}
"""ns that an input stands before the clock's edge: T_DICK, T_BACK, T_DS, T_MULIDCK and others."""

SETUP_OF_PIN = {("RAMB16", "EN"): 1.20, ("RAMB16", "WE"): 0.72, ("RAMB16", "SSR"): 1.65}
"""What of a block RAM's inputs takes longer: T_BECK, T_BWCK, T_BRCK."""

LUT = 0.44
"""ns through a LUT: T_ILO."""

MUXES = {"MUXF5": 0.44, "MUXF6": 0.45, "MUXF7": 0.45, "MUXF8": 0.45}
"""ns through a wide multiplexer, from its LUTs or its select."""

CARRY_IN, CARRY_ALONG, CARRY_OUT = 0.30, 0.053, 1.27
"""ns from a LUT into a carry chain, along it for a bit, and out of it through its XOR gate."""

MULTIPLIER, MULTIPLIER_BIT = 5.91, 0.12
"""ns through a multiplier to bit 35 of its product, and how much less for each bit below."""

CLOCKS = ("C", "CLKA", "CLKB", "WCLK")
REGISTERS = tuple(CLOCK_TO_OUT)
LUT_MEMORY = ("RAM16X1", "RAM32X1")
"""Memories made of LUTs: written at the clock's edge, and read as a LUT is, by their address."""

PADS = ("IBUF", "OBUF", "BUFG", "BUFGP")
FREE = ("INV", "GND", "VCC")
"""An inverter goes into the LUT or register behind it."""


class _Arrival(NamedTuple):
    """When a signal comes, which cell drives it, and from which pin and bit, if not a register."""

    ns: float
    cell: str
    pin: str = ""
    bit: int = -1


def net_delay(fan_out: int) -> float:
    """Return the ns that a wire to ``fan_out`` inputs is taken to need: a guess, see SOURCE."""
    return 0.6 + 0.2 * math.log2(max(fan_out, 1))


def estimate_timing(module: dict) -> dict:
    """Return an estimate of a flat netlist's clock rate, of the paths between registers alone.

    Parameters
    ----------
    module
        A module as Yosys writes it in JSON after ``synth_xilinx -family xc2v -ise -flatten``.

    Returns
    -------
    dict
        ``ns`` and ``mhz``; ``logic_ns`` and ``routing_ns`` of it; ``levels``: cells between the
        registers; ``path``: for each cell its ``type``, ``pin`` that the path enters by, ``signal``
        that it drives (nothing where it has no name in the source), ``net_ns`` before it and
        ``cell_ns`` in it;
        ``source`` of the delays.

    Raises
    ------
    RuntimeError
        If a cell is not known, signals run in a circle or no path joins two registers.
    """
    cells = {n: cell for n, cell in module["cells"].items() if cell["type"][0] != "$"}
    drivers = {bit: name for name, cell in cells.items() for _, bit in _pins(cell, "output")}
    fan_out = Counter(bit for cell in cells.values() for _, bit in _pins(cell, "input"))
    signals = _signals(module)

    arrivals: dict[int, _Arrival] = {}
    before = {
        name: {drivers[bit] for _, bit in _causes(cell) if bit in drivers}
        for name, cell in cells.items()
        if cell["type"].startswith(LUT_MEMORY) or not cell["type"].startswith((*REGISTERS, *PADS))
    }
    for name, cell in cells.items():
        kind = _register(cell["type"])
        for _, bit in _pins(cell, "output") if kind else ():
            arrivals[bit] = _Arrival(CLOCK_TO_OUT[kind], name)

    def comes(name: str, pin: str, bit: int) -> float:
        """Return when a bit comes to a pin, the wire to it included."""
        return arrivals[bit].ns + _wire(cells, arrivals[bit].cell, name, pin, fan_out[bit])

    for name in _sorted(before):
        if name not in before:
            continue  # a register or a pad
        cell = cells[name]
        known = [(pin, bit) for pin, bit in _causes(cell) if bit in arrivals]
        for out, driven in _outputs(cell):
            ways = [
                (comes(name, pin, bit) + _through(cell["type"], pin, out), pin, bit)
                for pin, bit in known
            ]
            if ways and (driven not in arrivals or max(ways)[0] > arrivals[driven].ns):
                ns, pin, bit = max(ways)
                arrivals[driven] = _Arrival(ns, name, pin, bit)

    ends = [
        (comes(name, pin, bit) + _setup(cell["type"], pin), name, pin, bit)
        for name, cell in cells.items()
        if _register(cell["type"])
        for pin, bit in _pins(cell, "input")
        if pin not in CLOCKS and bit in arrivals
    ]
    if not ends:
        raise RuntimeError("the netlist has no path from a register to a register")
    total, name, pin, bit = max(ends)
    path = []
    after, label = total, next((signals.get(end, "") for _, end in _outputs(cells[name])), "")
    while True:
        arrival = arrivals[bit]
        net = _wire(cells, arrival.cell, name, pin, fan_out[bit])
        path.append(_step(cells[name], pin, label, net, after - arrival.ns - net))
        after, label = arrival.ns, signals.get(bit, "")
        name, pin = arrival.cell, arrival.pin
        if not pin:
            break
        bit = arrival.bit
    path.append(_step(cells[name], "C", label, 0.0, after))
    path.reverse()
    routing = sum(step["net_ns"] for step in path)
    return {
        "ns": round(total, 2),
        "mhz": round(1000.0 / total, 1),
        "logic_ns": round(total - routing, 2),
        "routing_ns": round(routing, 2),
        "levels": len(path) - 2,
        "path": path,
        "source": SOURCE,
    }


def _step(cell: dict, pin: str, signal: str, net: float, gate: float) -> dict:
    """Return a cell of the path as the report has it."""
    return {
        "type": cell["type"],
        "pin": pin,
        "signal": signal,
        "net_ns": round(net, 2),
        "cell_ns": round(gate, 2),
    }


def _sorted(before: dict[str, set[str]]) -> Iterator[str]:
    """Yield the cells, each after those that drive it."""
    try:
        yield from TopologicalSorter(before).static_order()
    except CycleError as error:
        raise RuntimeError(f"the netlist has a combinational loop: {error.args[1]}") from None


def _register(kind: str) -> str:
    """Return which of the registers a cell is, or nothing."""
    return next((name for name in REGISTERS if kind.startswith(name)), "")


def _setup(kind: str, pin: str) -> float:
    """Return what a register's input needs before the clock's edge."""
    register = _register(kind)
    for (name, start), ns in SETUP_OF_PIN.items():
        if name == register and pin.startswith(start):
            return ns
    return SETUP[register]


def _through(kind: str, pin: str, out: tuple[str, int]) -> float:
    """Return the delay of a cell from one of its pins to a bit of its output."""
    if kind.startswith(("LUT", *LUT_MEMORY)):
        return LUT
    if kind in MUXES:
        return MUXES[kind]
    if kind == "MUXCY":
        return CARRY_ALONG if pin == "CI" else CARRY_IN
    if kind == "XORCY":
        return CARRY_OUT if pin == "CI" else CARRY_IN
    if kind == "MULT18X18":
        return MULTIPLIER - MULTIPLIER_BIT * (35 - out[1])
    if kind in FREE:
        return 0.0
    raise RuntimeError(f"no delay is known of the cell {kind}")


def _wire(cells: dict, driver: str, name: str, pin: str, fan_out: int) -> float:
    """Return the delay of the wire to a pin: none within a slice, or before an inverter."""
    source, sink = cells[driver]["type"], cells[name]["type"]
    logic = source.startswith(("LUT", "XORCY", "MUXF"))
    if sink in FREE:
        return 0.0
    if source == "MUXCY" and pin == "CI":
        return 0.0
    if source.startswith("LUT") and (sink, pin) in (("MUXCY", "S"), ("XORCY", "LI")):
        return 0.0
    if source.startswith(("LUT", "MUXF")) and sink in MUXES and pin != "S":
        return 0.0
    if logic and sink.startswith("FD") and pin == "D" and fan_out == 1:
        return 0.0
    return net_delay(fan_out)


def _causes(cell: dict) -> Iterator[tuple[str, int]]:
    """Yield the inputs that an output follows at once."""
    memory = cell["type"].startswith(LUT_MEMORY)
    for pin, bit in _pins(cell, "input"):
        if not memory or pin.startswith(("A", "DPRA")):
            yield pin, bit


def _outputs(cell: dict) -> Iterator[tuple[tuple[str, int], int]]:
    """Yield a cell's outputs with their index, and the bits that they drive."""
    for pin, direction in cell["port_directions"].items():
        if direction == "output":
            for index, bit in enumerate(cell["connections"][pin]):
                if isinstance(bit, int):
                    yield (pin, index), bit


def _pins(cell: dict, direction: str) -> Iterator[tuple[str, int]]:
    """Yield the pins of one direction with their bits, constants left out."""
    for pin, way in cell["port_directions"].items():
        if way == direction:
            for bit in cell["connections"][pin]:
                if isinstance(bit, int):
                    yield pin, bit


def _signals(module: dict) -> dict[int, str]:
    """Return the names that bits have in the source."""
    best: dict[int, tuple] = {}
    for name, net in module["netnames"].items():
        if name.startswith("$"):
            continue
        rank = (net["hide_name"], "$" in name, "." not in name, len(name), name)
        for place, bit in enumerate(net["bits"]):
            if isinstance(bit, int) and (bit not in best or rank < best[bit][0]):
                index = f"[{place}]" if len(net["bits"]) > 1 else ""
                best[bit] = rank, name + index
    return {bit: name for bit, (_, name) in best.items()}
