"""Targets of ``splatline bench accuracy``, with the figure reached and the verdict for each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from .sweep import FLOAT, FLOAT_DEPTHS, FLOAT_ONE_DEPTH, TWICE, plane_presets

__all__ = ["DEPTHS_LOSS", "FLOAT_LOSS", "TARGETS", "judge", "pick"]

_Run = dict[str, Any]

TARGETS = {
    "one_depth": "exact at most 0.5 dB below float with one depth a splat",
    "large": "exact above float with one depth a splat, for the larger splats",
    "over_paper": "exact at least 6 dB above paper, splats of 3.5 px",
    "four_samples": "the same, both with four samples a pixel",
    "fast": "fast within 0.5 dB of exact, splats of 3.5 px",
    "one_word": "fast with one code word an element, splats of 3.5 px",
    "holes": "exact's holes at most 1.1 times those of float",
    "plane": "a plane at most 1.2 dB below float, splats of every size",
    "plane_samples": "the same with four samples at most 0.5 dB below float with a 12-bit depth a"
    " pixel, at the points' spacing and twice as large",
}
"""Targets: name and meaning."""

FLOAT_LOSS, DEPTHS_LOSS = 1.2, 0.5
"""Most that an engine with planes may lose in dB: with one sample to float, and with four to float
with a 12-bit depth a pixel."""

LARGE = (7.0, 14.0)
"""Diameters in pixels of large elements."""

MIDDLE = 3.5
"""Diameter in pixels at which qualities differ most."""

MOST_WORDS = 1.005
"""Upper bound of code words an element that round to 1.00."""


def pick(runs: Iterable[_Run], **wanted: Any) -> Iterator[_Run]:
    """Return the runs with these values."""
    return (run for run in runs if all(run.get(key) == value for key, value in wanted.items()))


def judge(runs: list[_Run]) -> list[dict[str, Any]]:
    """Return a verdict for each scene, view, preset and target with the runs that it needs.

    Returns
    -------
    list of dict
        ``scene``, ``orbit``, ``preset``, ``target`` (a key of ``TARGETS``), ``figure`` (in dB, code
        words an element, or holes relative to those of float; None if infinite) and ``met``.
    """
    verdicts = []
    default = [run for run in runs if run["switched"] is None]
    cases = dict.fromkeys((run["scene"], tuple(run["orbit"])) for run in default)
    for scene, orbit in cases:
        here = list(pick(default, scene=scene, orbit=list(orbit)))
        for preset in dict.fromkeys(run["preset"] for run in here if run["preset"]):
            for target, (figure, met) in _figures(here, preset).items():
                where = {"scene": scene, "orbit": list(orbit), "preset": preset}
                verdicts.append({**where, "target": target, "figure": figure, "met": met})
    return verdicts


def _figures(runs: list[_Run], preset: str) -> dict[str, tuple[float | None, bool]]:
    """Return figure and verdict of each target for a scene, view and preset."""

    def find(quality: str, splats: Any, samples: int = 1) -> _Run | None:
        own = None if quality in (FLOAT, FLOAT_DEPTHS, FLOAT_ONE_DEPTH) else preset
        found = pick(runs, quality=quality, preset=own, splats=splats, samples=samples)
        return next(found, None)

    def apart(one: str, other: str, splats: Any, samples: int = 1) -> float | None:
        """Return the PSNR of one quality minus that of another, in dB."""
        upper, lower = find(one, splats, samples), find(other, splats, samples)
        if upper is None or lower is None:
            return None
        if upper["psnr_db"] is None or lower["psnr_db"] is None:  # no error at all
            return None
        return round(upper["psnr_db"] - lower["psnr_db"], 3)

    figures: dict[str, tuple[float | None, bool]] = {}
    fitted = apart("exact", FLOAT_ONE_DEPTH, "auto")
    if fitted is not None:
        figures["one_depth"] = fitted, fitted >= -0.5
    above = [gain for splats in LARGE
             if (gain := apart("exact", FLOAT_ONE_DEPTH, splats)) is not None]  # fmt: skip
    if above:
        figures["large"] = min(above), min(above) > 0.0
    for target, samples in (("over_paper", 1), ("four_samples", 4)):
        gain = apart("exact", "paper", MIDDLE, samples)
        if gain is not None:
            figures[target] = gain, gain >= 6.0
    loss = apart("exact", "fast", MIDDLE)
    fast = find("fast", MIDDLE)
    if loss is not None and fast is not None:
        figures["fast"] = loss, loss <= 0.5
        words = (fast["codewords"] - fast["control_words"]) / fast["elements"]
        figures["one_word"] = round(words, 4), words < MOST_WORDS
    if preset in plane_presets():
        figures |= _plane_figures(runs, apart)
    exact, sampled = find("exact", "auto"), find(FLOAT, "auto")
    if exact is not None and sampled is not None:
        figures["holes"] = _holes(exact["hole_fraction"], sampled["hole_fraction"])
    return figures


def _plane_figures(
    runs: list[_Run], apart: Callable[..., float | None]
) -> dict[str, tuple[float | None, bool]]:
    """Return the figures of an engine with planes; ``apart`` is that of :func:`_figures`."""
    figures: dict[str, tuple[float | None, bool]] = {}
    sizes = dict.fromkeys(run["splats"] for run in runs)
    losses = [gain for splats in sizes if (gain := apart("exact", FLOAT, splats)) is not None]
    if losses:
        figures["plane"] = min(losses), min(losses) >= -FLOAT_LOSS
    several = [
        gain
        for splats in ("auto", TWICE)
        if (gain := apart("exact", FLOAT_DEPTHS, splats, 4)) is not None
    ]
    if several:
        figures["plane_samples"] = min(several), min(several) >= -DEPTHS_LOSS
    return figures


def _holes(ours: float | None, bar: float | None) -> tuple[float | None, bool]:
    """Return our holes relative to the bar's, and whether they are few enough."""
    ours, bar = ours or 0.0, bar or 0.0
    if bar == 0.0:
        return (1.0, True) if ours == 0.0 else (None, False)
    return round(ours / bar, 3), ours <= 1.1 * bar
