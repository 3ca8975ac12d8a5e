"""The longest logic path of a netlist for Virtex-II: how many levels, and between which signals.

A level is a LUT, a multiplier without a register, or a carry chain, however long that is: a carry
takes a tenth of a LUT's time. Levels are not nanoseconds, but no delays are needed to count them,
and what a stage of the pipeline grows by shows at once.
"""

from __future__ import annotations

from .longest_path import LUT_MEMORIES, Step, find_longest, signal_names

__all__ = ["longest_path"]

A_CELL = 2.0**-20
"""What a cell counts beside its level: of paths with as many levels the one with more cells is the
longer."""

CONTROLS = {"CE": "clock enable of ", "R": "reset of ", "S": "set of "}
"""A flip-flop's inputs that are not its data."""


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
        As :func:`splatline.rtl.paths.find_longest` does.
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
    """Return what a step counts: an inverter is part of the pin that it leads to."""
    along = step.pin == "CI" and step.source == "MUXCY"
    return float(step.kind != "INV" and not along) + A_CELL


def _register_name(module: dict, name: str, names: dict[int, str], pin: str = "") -> str:
    """Return what to call a register: its output's signal, or the cell's name with the pin."""
    cell = module["cells"][name]
    if cell["type"].startswith("FD") and cell["connections"]["Q"][0] in names:
        return names[cell["connections"]["Q"][0]]
    return f"{name} {pin}".rstrip()
