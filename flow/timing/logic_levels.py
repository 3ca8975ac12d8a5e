"""The longest path of a Virtex-II netlist in logic levels.

A level is a LUT, a multiplier without a register, or a carry chain of any length: a carry takes a
tenth of a LUT's time. Levels are not nanoseconds, but need no delays, and show at once if a
pipeline stage becomes longer.
"""

from __future__ import annotations

from .longest_path import LUT_MEMORIES, Step, find_longest, signal_names

__all__ = ["longest_path"]

A_CELL = 2.0**-20
"""Weight of a cell beside its level: of paths of equal levels that with more cells is longer."""

CONTROLS = {"CE": "clock enable of ", "R": "reset of ", "S": "set of "}
"""Control inputs of a flip-flop."""


def longest_path(module: dict) -> dict:
    """Return the longest path from a register or memory to another, without ports.

    Parameters
    ----------
    module
        A flat module as Yosys writes it in JSON, made of Virtex-II's cells.

    Returns
    -------
    dict
        ``levels``; ``luts``, ``carries`` and ``multipliers`` on the path, in cells: a chain of ten
        carries counts ten; ``start`` and ``end``, by the names of signals.

    Raises
    ------
    RuntimeError
        As :func:`splatline.flow.timing.longest_path.find_longest` does.
    """
    path = find_longest(module, start=lambda _: 0.0, through=_levels, end=lambda _: 0.0)
    kinds = [step.kind for step in path.steps[:-1]]
    last = path.steps[-1]
    names = signal_names(module)
    return {
        "levels": int(path.total),
        "luts": sum(kind.startswith(("LUT", *LUT_MEMORIES)) for kind in kinds),
        "carries": sum(kind in ("MUXCY", "XORCY") for kind in kinds),
        "multipliers": kinds.count("MULT18X18"),
        "start": _register_name(module, path.start, names),
        "end": CONTROLS.get(last.pin, "") + _register_name(module, last.cell, names, last.pin),
    }


def _levels(step: Step) -> float:
    """Return the levels of a step. An inverter is part of the pin that it drives."""
    along = step.pin == "CI" and step.source == "MUXCY"
    return float(step.kind != "INV" and not along) + A_CELL


def _register_name(module: dict, name: str, names: dict[int, str], pin: str = "") -> str:
    """Return a register's name: the signal of its output, or else the cell with the pin."""
    cell = module["cells"][name]
    if cell["type"].startswith("FD") and cell["connections"]["Q"][0] in names:
        return names[cell["connections"]["Q"][0]]
    return f"{name} {pin}".rstrip()
