"""What the tests reach of the Verilog of the tops that people take."""

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from splatline.contract.presets import PRESETS
from splatline.flow.tops import TOPS
from tests.coverage.constants import find_constants
from tests.coverage.counts import reached, read_keys
from tests.coverage.excuses import EXCUSES, Excuse
from tests.coverage.modules import find_modules

__all__ = ["MEASURED", "Reach", "measure"]

MEASURED = (
    *(("paper", "engine"), ("rgb24", "engine"), ("plane", "engine"), ("swift", "engine")),
    ("paper", "axi"),
)
"""Presets and tops."""

COMMENT = ("//", "/*")

START = "if (_start_)"
"""Amaranth begins each block with this. ``_start_`` is 0; it is there for simulators alone."""


@dataclass
class Reach:
    """What is reached of the modules of one kind, such as the lanes of a top.

    Parameters
    ----------
    hit, total
        Points that are reached, and points that can be, by kind.
    constant
        Points of bits that no input can move.
    explained
        Points that are not reached, by the excuse that says why.
    missed
        The others.
    """

    hit: Counter[str] = field(default_factory=Counter)
    total: Counter[str] = field(default_factory=Counter)
    constant: int = 0
    explained: Counter[Excuse] = field(default_factory=Counter)
    missed: list[str] = field(default_factory=list)


def measure(folder: Path, preset: str, top: str) -> dict[str, Reach]:
    """Return what is reached of a top by the kind of module; numbers of instances are ``*``.

    Parameters
    ----------
    folder
        Counts of the runs; see ``counts``.
    preset, top
        One of ``MEASURED``.

    Raises
    ------
    LookupError
        If a module of the top is in no run.
    """
    text, _ = TOPS[top](PRESETS[preset], "splatline")
    if top == "engine":  # as the player's builds have it
        text = "\n".join(line for line in text.splitlines() if not line.startswith(COMMENT))
    constants = find_constants(text, "splatline")
    lines = text.splitlines()
    kinds: dict[str, Reach] = {}
    for module in find_modules(text):
        keys = read_keys(folder, module.digest)
        if not keys:
            raise LookupError(f"no run has the module {module.name} of {preset} {top}")
        kind = re.sub(r"\d+", "*", module.place) or "(top)"
        points = (
            (key, hit)
            for key, hit in zip(keys, reached(folder, module.digest), strict=True)
            if START not in lines[module.first - 1 + int(key.split(" ", 1)[0])]
        )
        _add(
            kinds.setdefault(kind, Reach()),
            f"{preset} {top} {kind}",
            points,
            constants.get(module.place, set()),
        )
    return kinds


def _add(reach: Reach, where: str, points, constants: set[str]) -> None:
    """Add the points of a module: pairs of key and whether it is reached."""
    for key, hit in points:
        line, _, kind, comment = key.split(" ", 3)
        signal = comment.rpartition(":")[0].replace("___05F", "__")
        if not hit and kind == "toggle" and signal in constants:
            reach.constant += 1
            continue
        reach.total[kind] += 1
        reach.hit[kind] += bool(hit)
        if hit:
            continue
        point = f"{where} {kind} {comment if kind == 'toggle' else f'line {line}: {comment}'}"
        for excuse in EXCUSES:
            if re.fullmatch(excuse.points, point):
                reach.explained[excuse] += 1
                break
        else:
            reach.missed.append(point)
