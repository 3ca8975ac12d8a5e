"""Targets of ``splatline bench engine``, with the worst run and the verdict for each."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any, NamedTuple

__all__ = ["LEAST_RATE", "TARGETS", "Target", "judge", "rate"]

_Run = dict[str, Any]


class Target(NamedTuple):
    """A limit on a figure of some runs.

    Parameters
    ----------
    meaning
        Description of the figure.
    figure
        Key of the figure in a run.
    limit
        Largest value of the figure.
    quality
        Quality of the runs that count; None: any.
    pixels
        Median diameter of their splats, both ends included; None: any.
    below
        The figure must be below the limit, not equal to it.
    """

    meaning: str
    figure: str
    limit: float
    quality: str | None = None
    pixels: tuple[float, float] | None = None
    below: bool = False

    def covers(self, run: _Run) -> bool:
        """Return whether a run counts."""
        low, high = self.pixels or (0.0, float("inf"))
        return self.quality in (None, run["quality"]) and low <= run["median_pixels"] <= high

    def met(self, figure: float) -> bool:
        """Return whether a figure is within the limit."""
        return figure < self.limit if self.below else figure <= self.limit


TARGETS = {
    "small": Target("cycles an element", "cycles_per_element", 1.10, "fast", (2.0, 4.0)),
    "large": Target("cycles an element", "cycles_per_element", 1.75, "fast", (6.0, 7.0)),
    "exact": Target("cycles a code word", "cycles_per_codeword", 1.1, "exact"),
    "bound": Target("cycles of the bound", "ratio", 1.08, below=True),
}
"""Targets by name."""


LEAST_RATE = 30_000
"""Target for elements a second per LUT at 100 MHz; the paper's engine has 11,600."""


def rate(runs: Sequence[_Run]) -> list[dict[str, Any]]:
    """Return each preset's rate per LUT over the runs of target ``small``; empty without LUTs.

    Returns
    -------
    list of dict
        ``preset``, ``lut4``, numbers of ``runs`` that count and of ``runs_met``; the ``most``,
        ``median`` and ``least`` elements a second per LUT, and the ``scene`` of the most.
    """
    rates = []
    key = "elements_per_second_per_lut"
    for preset in dict.fromkeys(run["preset"] for run in runs):
        counted = [run for run in runs if run["preset"] == preset and run[key] is not None]
        counted = [run for run in counted if TARGETS["small"].covers(run)]
        if not counted:
            continue
        figures = [run[key] for run in counted]
        best = max(counted, key=lambda run: run[key])
        rates.append(
            {
                "preset": preset,
                "lut4": best["lut4"],
                "runs": len(counted),
                "runs_met": sum(figure >= LEAST_RATE for figure in figures),
                "most": best[key],
                "scene": best["scene"],
                "median": round(statistics.median(figures)),
                "least": min(figures),
            }
        )
    return rates


def judge(runs: Sequence[_Run]) -> list[dict[str, Any]]:
    """Return a verdict for each preset and target with at least one run.

    Returns
    -------
    list of dict
        ``preset``, ``target`` (a key of ``TARGETS``), numbers of ``runs`` that count and of
        ``runs_met``; ``figure``, ``scene``, ``splats`` and ``quality`` of the worst run; ``met`` if
        all runs meet the target.
    """
    verdicts = []
    for preset in dict.fromkeys(run["preset"] for run in runs):
        for name, target in TARGETS.items():
            counted = [run for run in runs if run["preset"] == preset and target.covers(run)]
            if not counted:
                continue
            worst = max(counted, key=lambda run: run[target.figure])
            met = sum(target.met(run[target.figure]) for run in counted)
            verdicts.append(
                {
                    "preset": preset,
                    "target": name,
                    "runs": len(counted),
                    "runs_met": met,
                    "figure": worst[target.figure],
                    **{key: worst[key] for key in ("scene", "splats", "quality")},
                    "met": met == len(counted),
                }
            )
    return verdicts
