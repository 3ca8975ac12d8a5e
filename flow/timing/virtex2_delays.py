"""Estimates the clock rate of a netlist in a Virtex-II, as Xilinx' XST does before placement.

The cells are not placed, so the delay of a wire follows from its fan-out alone. The result is an
**estimate**: only placement and routing by the vendor's tools give the clock rate
(``docs/ise.md``).

**Source of the delays.** The tables of the data sheet (DS031 module 3) were not available. ISE
10.1.03 prints the delays of its speed files ("-4", "PRODUCTION 1.121 2008-07-25") in its reports.
Students of MIT's 6.111, whose board has an XC2V6000-4, have published such reports on GitHub:

- *trce*: github.com/paulinev/laser_pinball, ``camera/ise/camera_read/labkit.twr`` (blobs
  6887224762, 78652b2cfe, 388bd3ff2f): T_CKO 0.568, T_ILO 0.439, T_DICK 0.370, T_SRCK 0.280, T_BACK
  0.359, T_BECK 1.196, T_BWCK 0.718.
- *XST*, "Timing Detail" in 136 reports (``*.syr``), such as ``lolzhang/finallabkit.syr`` in
  github.com/lycarter/6.111-finalproj; others in leftger/bodydrums, liamcohen/ProjectedPiano,
  plancherb1/6.111-Final-Project: the same, and all delays not marked "from memory" below.
- *from memory of DS031*: the delays marked so, which were found nowhere.

**Accuracy.** The delays of wires are fitted to XST's: of 2,323 wires between slices in those
reports the worst differs by 0.004 ns. Of 97 paths between registers, of cells that occur here, 93
are within 0.01 ns of XST's; the other four are estimated too long here, by up to 0.84 ns. XST's own
estimate is inexact: for 43 clocks of those designs, without those of a DCM, the period after ``par
-ol std`` was 0.87 of XST's in the median, at least 0.54 and at most 1.52. Half of the designs used
under 3 % of their chip; in a full chip wires are longer.
"""

from __future__ import annotations

from itertools import pairwise

from .longest_path import LUT_MEMORIES, REGISTERS, Step, find_longest, pins, signal_names

__all__ = ["SOURCE", "estimate_timing", "net_delay"]

SOURCE = "Virtex-II -4: as XST 10.1.03 has cells, and wires by fan-out; some of RAMs from memory"
"""Source of the delays, in short."""

MEMORY_MUXES = {"RAM16X1": 0.0, "RAM32X1": 0.436, "RAM64X1": 0.883, "RAM128X1": 1.33}
"""ns of the wide multiplexers MUXF5..7 behind the LUTs of a distributed RAM of over 16 rows."""

CLOCK_TO_OUT = {"FD": 0.568, "RAMB16": 2.65, "MULT18X18S": 3.0}
CLOCK_TO_OUT |= {kind: 2.05 + muxes for kind, muxes in MEMORY_MUXES.items()}
"""ns from the clock edge to an output: T_CKO, T_BCKO, T_SHCKO16, T_MULTCK.

All but the first are from memory. T_BACK, T_BECK and T_BWCK of the same table as T_BCKO were
remembered correctly, and so were T_DS and T_WES of that of T_SHCKO16. No MULT18X18S is used.
"""

SETUP = {"FD": 0.370, "RAMB16": 0.359, "MULT18X18S": 3.890}
SETUP |= dict.fromkeys(LUT_MEMORIES, 0.667)
"""Setup time in ns before the clock edge: T_DICK, T_BACK, T_DS, T_MULIDCK.

T_DS was found for SRL16E, which is a LUT as well. From memory: T_BDCK equals T_BACK, and T_AS is
less than T_DS.
"""

SETUP_OF_PIN = {
    ("FD", "CE"): 0.240,
    ("FD", "R"): 0.280,
    ("FD", "S"): 0.280,
    ("RAMB16", "EN"): 1.196,
    ("RAMB16", "WE"): 0.718,
    ("RAMB16", "SSR"): 1.65,
    **{(kind, "WE"): 0.525 for kind in LUT_MEMORIES},
}
"""Setup time of other pins: T_CECK, T_SRCK, T_BECK, T_BWCK, T_BRCK (from memory), T_WES."""

LUT = 0.439
"""ns through a LUT: T_ILO."""

LUT_READ = 0.938
"""ns to read a distributed RAM of 16 rows: XST's delay of RAM32X1D, 1.374, without its MUXF5. The
data sheet has T_ILO for it (from memory)."""

MUXES = {"MUXF5": (0.436, 0.699), "MUXF6": (0.447, 0.570)}
MUXES |= dict.fromkeys(("MUXF7", "MUXF8"), MUXES["MUXF6"])
"""ns through a wide multiplexer, from its inputs and from its select. The select of MUXF7 and MUXF8
was not found."""

CARRIES = {
    ("MUXCY", "S"): 0.298,
    ("MUXCY", "DI"): 0.462,
    ("MUXCY", "CI"): 0.053,
    ("XORCY", "LI"): 0.684,
    ("XORCY", "CI"): 1.274,
}
"""ns through the cells of a carry chain, by the pin."""

CARRY_OUT = 0.889
"""ns from a carry chain to a wire without an XORCY."""

MULTIPLIER, MULTIPLIER_BIT = 3.111, 0.207
"""ns through a multiplier to bit 0 of its product, and for each further bit. Found for bits 7 to 27
(4.560 to 8.700); bit 35 is then 10.356. These are of stepping 0, ISE's default. Chips of stepping 1
are faster, 5.91 for bit 35 (from memory)."""

NETS = ((1, 0.517), (2, 0.701), (14, 0.977), (19, 1.035), (25, 1.069), (479, 2.249))
"""ns of a wire by its fan-out, with linear interpolation."""

LUT_PINS = {"I0": 0.286, "I1": 0.209, "I2": 0.035, "I3": 0.040}
"""Additional ns of a wire to a pin of a LUT."""


def net_delay(fan_out: int) -> float:
    """Return the ns of a wire with a fan-out, by NETS."""
    beyond = NETS[-2], NETS[-1]
    line = next((points for points in pairwise(NETS) if fan_out <= points[1][0]), beyond)
    (few, soon), (many, late) = line
    return soon + (late - soon) * (max(fan_out, 1) - few) / (many - few)


def estimate_timing(module: dict) -> dict:
    """Estimate a flat netlist's clock rate from the paths between registers.

    Parameters
    ----------
    module
        A module as Yosys writes it in JSON after ``synth_xilinx -family xc2v -ise -flatten``.

    Returns
    -------
    dict
        ``ns`` and ``mhz``; ``logic_ns`` and ``routing_ns`` of it; ``levels``: cells between the
        registers; ``path``: for each cell its ``type``, input ``pin``, the ``signal`` that it
        drives (empty if it has no name in the source), ``net_ns`` before it and ``cell_ns`` in it;
        ``source`` of the delays.

    Raises
    ------
    RuntimeError
        As :func:`splatline.flow.timing.longest_path.find_longest` does.
    """
    total, start, steps = find_longest(
        module,
        start=lambda kind: CLOCK_TO_OUT[_register(kind)],
        through=lambda step: _leave(step) + _wire(step) + _gate(step),
        end=lambda step: _leave(step) + _wire(step) + _setup(step),
    )
    names = signal_names(module)
    end = module["cells"][steps[-1].cell]
    kinds = [module["cells"][start]["type"], *(step.kind for step in steps)]
    entered = ["C", *(step.pin for step in steps)]
    driven = [*(step.bit for step in steps), next((bit for *_, bit in pins(end, "output")), -1)]
    nets = [0.0, *map(_wire, steps)]
    gates = [CLOCK_TO_OUT[_register(kinds[0])], *map(_gate, steps[:-1]), _setup(steps[-1])]
    leaving = [*map(_leave, steps), 0.0]
    path = [
        {
            "type": kind,
            "pin": pin,
            "signal": names.get(bit, ""),
            "net_ns": round(net, 2),
            "cell_ns": round(gate + out, 2),
        }
        for kind, pin, bit, net, gate, out in zip(
            kinds, entered, driven, nets, gates, leaving, strict=True
        )
    ]
    return {
        "ns": round(total, 2),
        "mhz": round(1000.0 / total, 1),
        "logic_ns": round(total - sum(nets), 2),
        "routing_ns": round(sum(nets), 2),
        "levels": len(path) - 2,
        "path": path,
        "source": SOURCE,
    }


def _register(kind: str) -> str:
    """Return the kind of register of a cell."""
    return next(name for name in REGISTERS if kind.startswith(name))


def _setup(step: Step) -> float:
    """Return the setup time of a register's input."""
    register = _register(step.kind)
    for (name, start), ns in SETUP_OF_PIN.items():
        if name == register and step.pin.startswith(start):
            return ns
    return SETUP[register]


def _gate(step: Step) -> float:
    """Return the delay of the cell that a step drives."""
    if step.kind.startswith("LUT"):
        return LUT
    if step.kind.startswith(LUT_MEMORIES):
        return LUT_READ + MEMORY_MUXES[_register(step.kind)]
    if step.kind in MUXES:
        return MUXES[step.kind][step.pin == "S"]
    if step.kind == "MULT18X18":
        return MULTIPLIER + MULTIPLIER_BIT * step.out
    if step.kind == "INV":
        return 0.0  # it becomes part of the LUT or register behind it
    return CARRIES[step.kind, step.pin]


def _leave(step: Step) -> float:
    """Return the delay of a step out of a carry chain, or 0."""
    return CARRY_OUT if step.source == "MUXCY" and step.pin != "CI" else 0.0


def _wire(step: Step) -> float:
    """Return the delay of a step's wire; 0 within a slice and before an inverter."""
    wide = step.source.startswith(("LUT", "MUXF"))
    data = step.kind.startswith("FD") and step.pin == "D"
    if step.kind == "INV":
        return 0.0
    if step.source == "MUXCY" and step.pin == "CI":
        return 0.0
    if step.source.startswith("LUT") and (step.kind, step.pin) in (("MUXCY", "S"), ("XORCY", "LI")):
        return 0.0
    if wide and step.kind in MUXES and step.pin != "S":
        return 0.0
    if data and step.fan_out == 1 and (wide or step.source == "XORCY"):
        return 0.0
    extra = LUT_PINS[step.pin] if step.kind.startswith("LUT") else 0.0
    return net_delay(step.fan_out) + extra
