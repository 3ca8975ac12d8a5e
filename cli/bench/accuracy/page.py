"""The Markdown page of ``splatline bench accuracy``, made from its JSON alone."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import Any

from splatline.cli.bench.markdown import table

from .planes import plane_section
from .sweep import FLOAT, FLOAT_ONE_DEPTH, TWICE, way
from .targets import TARGETS, judge, pick

__all__ = ["budgets", "fitted", "page", "title"]

_Run = dict[str, Any]

ERRORS = (
    ("psnr_db", "PSNR", "{:.2f}"),
    ("psnr_foreground_db", "foreground", "{:.2f}"),
    ("psnr_blurred_db", "blurred", "{:.2f}"),
    ("ssim", "SSIM", "{:.4f}"),
    ("hole_fraction", "holes", "{:.4%}"),
    ("silhouette_iou", "silhouette IoU", "{:.4f}"),
    ("depth_rmse", "depth RMS", "{:.4f}"),
)
"""Measures of error: key, heading, format."""


def page(results: Mapping[str, Any], pictures: Iterable[str]) -> str:
    """Return the page as Markdown.

    Parameters
    ----------
    results
        Contents of the JSON.
    pictures
        File names of the picture sheets.
    """
    runs = results["runs"]
    tools = ", ".join(f"{name} {version}" for name, version in results["tools"].items())
    width, height = results["size"]
    machine = results["machine"]
    samples = results["reference_samples"]
    parts = [
        "# Accuracy",
        f"Made by `splatline bench accuracy` from [accuracy.json](accuracy.json). Pictures have"
        f" {width} x {height} pixels, and the reference has {samples} x {samples} samples a"
        f" pixel. {machine['processor'] or machine['platform']}, {machine['cores']} cores; {tools}."
        " Times are those of the processor, of all its cores together, the least of"
        f" {results['repeats']} warm calls; other programs that run change them little.",
        "## Targets",
        *(f"- {name}: {meaning}." for name, meaning in TARGETS.items()),
        _targets(runs),
        *plane_section(runs),
        "## Run time against error",
        "Splats of the points' spacing. PSNR is the mean over all scenes and views, costs are"
        " geometric means. Points with a light rim are on the Pareto front.",
        "![Run time against error](pareto.png)",
        "![Each scene](pareto_scenes.png)",
        "## Error budget",
        "PSNR in dB after each step, from exact samples to the engine's picture. Each"
        " column has all approximations of the columns to its left. The last column is the golden"
        " renderer's picture of the code words. Its difference from the column before is the effect"
        " of approximations that the budget leaves out.",
        "![Error budget, mean over the scenes](waterfall.png)",
        *_budget_tables(results),
        "## Splats of the points' spacing",
        "PSNR in dB over the image, over the pixels whose coverage in the reference is above a"
        " half, and of the error blurred by 1.5 pixels, as seen from afar."
        " `exact \N{MULTIPLICATION SIGN}4` has four samples a pixel (`render --samples 4`); its"
        " times, words and cycles are those of all samples together.",
        _fitted_table(runs),
        "## Splats of other sizes",
        "PSNR in dB; a size in pixels is the median diameter.",
        _sizes_table(runs),
        "## Skips",
        "Each row but the first of a scene has one skip switched from its default. The first row"
        " has the default skips. Quality is the default, preset is `paper`.",
        _skips_table(runs),
        "## Pictures",
        *(f"![{name}]({name})" for name in pictures),
    ]
    return "\n\n".join(_join_lists(part for part in parts if part)) + "\n"


def title(row: Mapping[str, Any]) -> str:
    """Return the name of a scene and view."""
    azimuth, elevation = row["orbit"]
    return f"{row['scene']} ({azimuth:g}, {elevation:g})"


def fitted(runs: Iterable[_Run]) -> dict[str, list[_Run]]:
    """Return the engines' runs with splats of the points' spacing, by scene and view.

    In the returned runs, ``seconds`` is the processor's time for host and golden renderer,
    ``cycles_per_element`` is that of all samples, and ``way`` names quality and samples.
    """
    scenes: dict[str, list[_Run]] = {}
    for run in pick(runs, splats="auto", switched=None):
        if run["preset"] is not None and run["psnr_db"] is not None:
            seconds = math.fsum(run["processor_seconds"].values())
            cycles = run["cycles_per_element"]
            costs = {"seconds": seconds, "cycles_per_element": cycles and cycles * run["samples"]}
            shown = {**run, **costs, "way": way(run["quality"], run["samples"])}
            scenes.setdefault(title(run), []).append(shown)
    return scenes


def budgets(
    results: Mapping[str, Any],
) -> dict[tuple[Any, str, str, int], dict[str, dict[str, float]]]:
    """Return error budgets: PSNR by (splats, quality, preset, samples), scene and step.

    The last step is golden.
    """
    found: dict[tuple[Any, str, str, int], dict[str, dict[str, float]]] = {}
    for row in results["ladders"]:
        scenes = found.setdefault(_budget_key(row), {})
        scenes.setdefault(title(row), {})[row["step"]] = row["psnr_db"]
    for run in pick(results["runs"], switched=None):
        scenes = found.get(_budget_key(run), {})
        if title(run) in scenes:
            scenes[title(run)]["golden"] = run["psnr_db"]
    return found


def _budget_key(row: Mapping[str, Any]) -> tuple[Any, str, str, int]:
    return row["splats"], row["quality"], row["preset"], row["samples"]


def size_name(splats: Any) -> str:
    """Return the name of a size of splats."""
    if splats == TWICE:
        return "twice the points' spacing"
    return "the points' spacing" if splats == "auto" else f"{splats:g} px"


def _targets(runs: list[_Run]) -> str:
    rows: dict[tuple[str, str], list[str]] = {}
    for verdict in judge(runs):
        row = rows.setdefault((title(verdict), verdict["preset"]), ["-"] * len(TARGETS))
        figure = "infinite" if verdict["figure"] is None else f"{verdict['figure']:.2f}"
        met = "met" if verdict["met"] else "**not met**"
        row[list(TARGETS).index(verdict["target"])] = f"{figure}, {met}"
    return table(["scene", "preset", *TARGETS], [[*key, *row] for key, row in rows.items()], 2)


def _budget_tables(results: Mapping[str, Any]) -> Iterable[str]:
    for (splats, quality, preset, samples), scenes in budgets(results).items():
        steps = list(next(iter(scenes.values())))
        yield (
            f"Preset `{preset}`, quality `{way(quality, samples)}`, splats of {size_name(splats)}."
            f" {_next_in_line(steps, scenes)}"
        )
        rows = [
            [name, *(f"{values[step]:.2f}" if values.get(step) is not None else "-"
                     for step in steps)]
            for name, values in scenes.items()
        ]  # fmt: skip
        yield table(["scene", *steps], rows, 1)


def _next_in_line(steps: list[str], scenes: Mapping[str, Mapping[str, float]]) -> str:
    """Return a sentence on the largest losses of a budget, in the mean of its scenes."""
    losses = {}
    for before, step in itertools.pairwise(steps):
        changes = [
            values[step] - values[before]
            for values in scenes.values()
            if values.get(step) is not None and values.get(before) is not None
        ]
        if changes:
            losses[step] = math.fsum(changes) / len(changes)
    most = sorted(losses.items(), key=lambda item: item[1])[:2]
    named = ", then ".join(f"{step} ({loss:+.2f} dB)" for step, loss in most)
    return f"Largest losses in the mean: {named}."


def _fitted_table(runs: list[_Run]) -> str:
    heads = ["scene", "quality", "preset", "host ms", "golden ms", "words an element",
             "cycles an element", *(head for _, head, _ in ERRORS)]  # fmt: skip
    rows = []
    for run in pick(runs, splats="auto", switched=None):
        seconds = run["processor_seconds"] or {}
        rows.append(
            [
                title(run),
                way(run["quality"], run["samples"]),
                run["preset"] or "-",
                _format(seconds.get("host"), "{:.1f}", 1e3),
                _format(seconds.get("golden"), "{:.1f}", 1e3),
                _words(run),
                _format(run["cycles_per_element"], "{:.3f}", run["samples"]),
                *(_format(run[key], template) for key, _, template in ERRORS),
            ]
        )
    return table(heads, rows, 3)


def _sizes_table(runs: list[_Run]) -> str:
    engines = [
        run for run in pick(runs, switched=None) if run["splats"] != "auto" and run["preset"]
    ]
    columns = list(dict.fromkeys(map(_column, engines)))
    rows = []
    for key in dict.fromkeys((title(run), run["splats"]) for run in engines):
        here = [run for run in pick(runs, switched=None, splats=key[1]) if title(run) == key[0]]
        values = {_column(run): run["psnr_db"] for run in here}
        bars = [values.get((None, quality)) for quality in (FLOAT, FLOAT_ONE_DEPTH)]
        found = [*bars, *(values.get(column) for column in columns)]
        rows.append([key[0], size_name(key[1]), *(_format(value, "{:.2f}") for value in found)])
    heads = ["scene", "splats", FLOAT, FLOAT_ONE_DEPTH]
    heads += [f"{preset} {name}" for preset, name in columns]
    return table(heads, rows, 2)


def _column(run: _Run) -> tuple[str | None, str]:
    """Return a run's column: preset, and name of quality and samples."""
    return run["preset"], way(run["quality"], run["samples"])


def _skips_table(runs: list[_Run]) -> str:
    heads = ["scene", "skips", "host ms", "golden ms", "elements", "code words",
             "cycles an element", *(head for _, head, _ in ERRORS)]  # fmt: skip
    changed = [run for run in runs if run["switched"] is not None]
    rows = []
    for scene in dict.fromkeys(map(title, changed)):
        first = next(run for run in changed if title(run) == scene)
        own = {key: first[key] for key in ("quality", "preset", "splats")}
        own |= {"switched": None, "samples": 1}
        default = [run for run in pick(runs, **own) if title(run) == scene]
        rows += [
            [
                scene,
                ", ".join(run["skips"]) or "none",
                _format(run["processor_seconds"]["host"], "{:.1f}", 1e3),
                _format(run["processor_seconds"]["golden"], "{:.1f}", 1e3),
                f"{run['elements']:,}",
                f"{run['codewords']:,}",
                _format(run["cycles_per_element"], "{:.3f}"),
                *(_format(run[key], template) for key, _, template in ERRORS),
            ]
            for run in [*default, *(run for run in changed if title(run) == scene)]
        ]
    return table(heads, rows, 2) if rows else ""


def _words(run: _Run) -> str:
    """Return a run's code words an element, without control words."""
    if not run["elements"]:
        return "-"
    words = (run["codewords"] - run["control_words"]) / run["elements"]
    return f"{words * run['samples']:.2f}"


def _format(value: float | None, template: str, factor: float = 1.0) -> str:
    return "-" if value is None else template.format(factor * value)


def _join_lists(parts: Iterable[str]) -> list[str]:
    """Join the entries of each Markdown list, without empty lines between them."""
    joined: list[str] = []
    for part in parts:
        if part.startswith("- ") and joined and joined[-1].startswith("- "):
            joined[-1] += "\n" + part
        else:
            joined.append(part)
    return joined
