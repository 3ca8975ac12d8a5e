"""Output files of ``splatline bench accuracy``: JSON, page, plots and sheets of pictures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.options.outputs import lines_of_json

from .page import budgets, fitted, page, size_name
from .planes import judge_means
from .sweep import TWICE, way
from .targets import judge

if TYPE_CHECKING:
    from splatline.plots.bench_pictures import Crops

__all__ = ["write_accuracy"]


def write_accuracy(out_dir: Path, results: dict[str, Any], crops: Sequence[Crops]) -> list[Path]:
    """Write ``accuracy.json``, ``accuracy.md``, the plots and the sheets of pictures.

    All contents are made before the first file is written. Each file is written atomically.

    Returns
    -------
    list of Path
        The files.
    """
    from splatline.contract.atomic_write import atomic_write
    from splatline.plots.bench_plots import plot_pareto, plot_pareto_scenes, plot_waterfall

    runs = results["runs"]
    results = {**results, "targets": judge(runs), "plane_means": judge_means(runs)}
    scenes = fitted(results["runs"])
    sheets = _sheets(crops, results["runs"])
    files = {
        "accuracy.json": lines_of_json(results).encode(),
        "accuracy.md": page(results, sheets).encode(),
        "pareto.png": plot_pareto(_mean(scenes)),
        "pareto_scenes.png": plot_pareto_scenes(scenes),
        "waterfall.png": plot_waterfall(_panels(results)),
        **sheets,
    }
    out_dir.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        path = out_dir / name
        path.parent.mkdir(exist_ok=True)
        atomic_write(path, data)
    return [out_dir / name for name in files]


def _mean(scenes: Mapping[str, Sequence[Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """Return the mean PSNR and the geometric mean costs over all scenes, by way and preset."""
    groups: dict[tuple[str, int, str], list[Mapping[str, Any]]] = {}
    for runs in scenes.values():
        for run in runs:
            key = run["quality"], run["samples"], run["preset"]
            groups.setdefault(key, []).append(run)

    def geometric(key: str, runs: Sequence[Mapping[str, Any]]) -> float | None:
        values = [run[key] for run in runs]
        if any(value is None for value in values):
            return None
        return math.exp(math.fsum(map(math.log, values)) / len(values))

    return [
        {
            "quality": quality,
            "samples": samples,
            "way": way(quality, samples),
            "preset": preset,
            "psnr_db": math.fsum(run["psnr_db"] for run in runs) / len(runs),
            "seconds": geometric("seconds", runs),
            "cycles_per_element": geometric("cycles_per_element", runs),
        }
        for (quality, samples, preset), runs in groups.items()
    ]


def _panels(results: Mapping[str, Any]) -> list[tuple[str, dict[str, list[float]]]]:
    """Return the panels of the error budget: splats of the points' spacing, and twice as large."""
    panels = []
    for (size, quality, preset, samples), scenes in budgets(results).items():
        if size in ("auto", TWICE):
            steps = next(iter(scenes.values()))
            heights = {step: [scene[step] for scene in scenes.values()] for step in steps}
            named = way(quality, samples)
            panels.append((f"preset {preset}, {named}, splats of {size_name(size)}", heights))
    return panels


def _sheets(crops: Sequence[Crops], runs: Sequence[Mapping[str, Any]]) -> dict[str, bytes]:
    """Return a sheet of pictures for each scene and view, by file name."""
    from splatline.plots.bench_pictures import SHOWN, compose_pictures

    views: dict[tuple[str, tuple[float, float]], list[Crops]] = {}
    for crop in crops:
        if crop.splats in SHOWN:
            views.setdefault((crop.scene, crop.orbit), []).append(crop)
    sheets = {}
    for (scene, orbit), cases in views.items():
        psnr = {
            (
                None if run["splats"] == "auto" else run["splats"],
                way(run["quality"], run["samples"]),
                run["preset"],
            ): run["psnr_db"]
            for run in runs
            if run["scene"] == scene and run["orbit"] == list(orbit) and run["switched"] is None
        }
        several = sum(name == scene for name, _ in views) > 1
        suffix = f"_{orbit[0]:g}_{orbit[1]:g}" if several else ""
        sheets[f"pictures/{scene}{suffix}.png"] = compose_pictures(cases, psnr)
    return sheets
