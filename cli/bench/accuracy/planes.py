"""The page of ``splatline bench accuracy``: engines with planes beside float, and in the mean."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from splatline.cli.bench.markdown import table

from .sweep import FLOAT, FLOAT_DEPTHS, SAMPLED, TWICE, plane_presets
from .targets import DEPTHS_LOSS, FLOAT_LOSS, pick

__all__ = ["MEANS", "judge_means", "plane_section"]

_Run = Mapping[str, Any]

MEANS = {4: 37.0, 16: 39.0}
"""Samples a pixel, and the least mean PSNR in dB over all scenes at the points' spacing."""

SIZES = {"auto": "the points' spacing", TWICE: "twice as large"}


def judge_means(runs: Iterable[_Run]) -> list[dict[str, Any]]:
    """Return the mean PSNR of each engine with planes over all scenes and views, and its verdict.

    Returns
    -------
    list of dict
        ``preset``, ``samples``, ``pictures`` (how many the mean is of), ``psnr_db``, ``least`` (the
        goal; None: there is none) and ``met``. Splats have the points' spacing.
    """
    runs = [run for run in runs if run["switched"] is None]
    found = []
    for preset in _presets(runs):
        for samples in SAMPLED:
            here = pick(runs, preset=preset, samples=samples, splats="auto")
            values = [run["psnr_db"] for run in here if run["psnr_db"] is not None]
            if values:
                mean, least = math.fsum(values) / len(values), MEANS.get(samples)
                found.append(
                    {
                        "preset": preset,
                        "samples": samples,
                        "pictures": len(values),
                        "psnr_db": round(mean, 3),
                        "least": least,
                        "met": None if least is None else mean >= least,
                    }
                )
    return found


def plane_section(runs: Iterable[_Run]) -> list[str]:
    """Return the section's paragraphs as Markdown; none if no engine has planes."""
    runs = [run for run in runs if run["switched"] is None]
    presets = _presets(runs)
    if not presets:
        return []
    means = [
        f"- `{mean['preset']}`, {mean['samples']} samples a pixel: {mean['psnr_db']:.2f} dB,"
        f" the mean of {mean['pictures']} pictures ({_goal(mean)})."
        for mean in judge_means(runs)
    ]
    counts = " / ".join(map(str, SAMPLED))
    return [
        "## Planes",
        "Engines whose code words carry a plane, so that every pixel has a depth of its own. Means"
        " over all scenes and views, with splats of the points' spacing:",
        *(mean.replace("1 samples", "one sample") for mean in means),
        f"PSNR in dB with {counts} samples a pixel. `{FLOAT_DEPTHS}` has the engine's depth bits,"
        " colours and shading, and the disc's true depth at every pixel; it rounds all samples"
        f" alike, and engines do not. Goals: with one sample at most {FLOAT_LOSS} dB below float,"
        f" with four at most {DEPTHS_LOSS} dB below `{FLOAT_DEPTHS}`.",
        _table(runs, presets),
    ]


def _presets(runs: Iterable[_Run]) -> list[str]:
    """Return the engines with planes among the runs."""
    drawn = {run["preset"] for run in runs}
    return [name for name in plane_presets() if name in drawn]


def _table(runs: list[_Run], presets: list[str]) -> str:
    columns = [(FLOAT, None), (FLOAT_DEPTHS, None), ("exact", "rgb24")]
    columns += [("exact", preset) for preset in presets]
    rows = []
    for scene, orbit in dict.fromkeys((run["scene"], tuple(run["orbit"])) for run in runs):
        for splats, size in SIZES.items():
            here = list(pick(runs, scene=scene, orbit=list(orbit), splats=splats))
            values = {
                (run["quality"], run["preset"], run["samples"]): run["psnr_db"] for run in here
            }
            if not here:
                continue
            ours = ("exact", presets[0])
            losses = [
                _loss(values.get((*ours, samples)), values.get((bar, None, samples)), most)
                for samples, bar, most in ((1, FLOAT, FLOAT_LOSS), (4, FLOAT_DEPTHS, DEPTHS_LOSS))
            ]
            found = (
                " / ".join(_decibels(values.get((*column, samples))) for samples in SAMPLED)
                for column in columns
            )
            rows.append([f"{scene} ({orbit[0]:g}, {orbit[1]:g})", size, *found, *losses])
    heads = [
        "scene", "splats", FLOAT, FLOAT_DEPTHS, "`rgb24`, exact",
        *(f"`{name}`" for name in presets), "1 sample, less float", "4 samples, less 12-bit depth",
    ]  # fmt: skip
    return table(heads, rows, 2)


def _loss(ours: float | None, bar: float | None, most: float) -> str:
    """Return the difference from a bar, and whether it is at most ``most`` below it."""
    if ours is None or bar is None:
        return "-"
    return f"{ours - bar:+.2f}, {'met' if ours - bar >= -most else '**not met**'}"


def _goal(mean: Mapping[str, Any]) -> str:
    if mean["least"] is None:
        return "no goal"
    return f"goal {mean['least']:g}, {'met' if mean['met'] else '**not met**'}"


def _decibels(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}"
