"""What ``splatline bench accuracy`` measures: each quality, preset and skip, and the budget."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from splatline.cli.bench.statistics import drawing_statistics, tool_versions
from splatline.cli.bench.subjects import poses

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.config import EngineConfig
    from splatline.contract.frame import Frame
    from splatline.contract.raster import Raster
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View
    from splatline.plots.bench_pictures import Crops
    from splatline.sim.reference.reference import Reference

__all__ = ["FLOAT", "FLOAT_ONE_DEPTH", "Sweep", "measure", "way"]

FLOAT = "float"
FLOAT_ONE_DEPTH = "float, one depth a splat"
"""Qualities of no engine: one exact sample a pixel, and the same with one depth for each splat."""

ONCE = {"materials", "index"}
"""Stages of the host that a cloud needs once, not every frame."""


def way(quality: str, samples: int) -> str:
    """Return what to call a quality drawn with some samples a pixel."""
    return quality if samples == 1 else f"{quality} \N{MULTIPLICATION SIGN}{samples}"


@dataclass(frozen=True)
class Sweep:
    """What is measured.

    Parameters
    ----------
    paths, scenes
        Clouds and built-in scenes.
    views
        Orbits; empty: each scene's own, and the default one for a cloud.
    size
        Of the image.
    splats
        Medians of the splats' diameters in pixels; None: the points' own spacing.
    presets
        Engines that splats of the points' spacing are drawn for.
    fewer_presets
        Engines that splats of other sizes are drawn for.
    ladders
        Splats of which the error budget is drawn up.
    sampled
        Splats that are drawn with several samples a pixel as well.
    samples
        How many, by the presets that draw them.
    repeats
        Calls of host and golden renderer, of which the fastest counts.
    """

    paths: tuple[Path, ...]
    scenes: tuple[str, ...]
    views: tuple[tuple[float, float], ...]
    size: tuple[int, int] = (512, 512)
    splats: tuple[float | None, ...] = (None, 1.5, 3.5, 7.0, 14.0)
    presets: tuple[str, ...] = ("paper", "rgb24", "depth12")
    fewer_presets: tuple[str, ...] = ("paper", "rgb24")
    ladders: tuple[float | None, ...] = (None, 3.5, 7.0)
    sampled: tuple[float | None, ...] = (None, 3.5, 7.0)
    samples: Mapping[str, tuple[int, ...]] = field(
        default_factory=lambda: {"paper": (4, 16), "rgb24": (4, 16)}
    )
    repeats: int = 3

    def total(self) -> int:
        """Return the number of pictures that will be compared."""
        each = sum(len(_plan(self, splats)) + _rungs(self, splats) for splats in self.splats)
        return each * (len(self.scenes) + len(self.paths)) * max(len(self.views), 1)


@dataclass(frozen=True)
class Run:
    """One picture to be drawn.

    Parameters
    ----------
    quality
        Of the host, or a float quality.
    preset
        The engine; None: drawn by none.
    switched
        The skip that is not as the host has it by default.
    samples
        A pixel, each from a frame of its own.
    """

    quality: str
    preset: str | None = None
    switched: str | None = None
    samples: int = 1


@dataclass
class Case:
    """A cloud, a view and a size of splats, with the picture to compare with."""

    scene: str
    cloud: Cloud
    view: View
    camera: dict[str, Any]
    source: str
    splats: float | None
    median: float
    radii: npt.NDArray[np.float64]
    exact: Reference
    background: tuple[float, float, float]
    crops: Crops

    @property
    def key(self) -> dict[str, Any]:
        """What tells the case from others."""
        return {
            "scene": self.scene,
            "orbit": list(self.camera["orbit"]),
            "splats": self.splats or "auto",
            "median_pixels": round(self.median, 3),
        }


def measure(sweep: Sweep, advance: Callable[[str], None]) -> tuple[dict[str, Any], list[Crops]]:
    """Measure everything.

    Parameters
    ----------
    sweep
        What.
    advance
        Called with a description before each picture that is compared.

    Returns
    -------
    results
        Ready for JSON: ``machine``, ``tools``, ``runs`` and ``ladders``.
    crops
        The pictures behind the numbers, of each case.
    """
    runs: list[dict[str, Any]] = []
    ladders: list[dict[str, Any]] = []
    crops = []
    for case in _cases(sweep):
        for run in _plan(sweep, case.splats):
            several = f", {run.samples} samples" if run.samples > 1 else ""
            what = f"{run.quality} {run.preset or ''}{several}"
            advance(f"{case.scene}, {case.splats or 'auto'}: {what}")
            runs.append(_draw_float(case, run) if run.preset is None else _draw(case, run, sweep))
        # What a float row has no value for is null, so that every run has the same keys.
        ladders += _walk(case, sweep, advance)
        crops.append(case.crops)
    keys = list(dict.fromkeys(key for run in reversed(runs) for key in run))
    runs = [{key: run.get(key) for key in keys} for run in runs]
    results = {
        "machine": {"platform": platform.platform(), "processor": _processor(), "cores": _cores()},
        "tools": tool_versions("golden"),
        "size": list(sweep.size),
        "reference_samples": 4,
        "repeats": sweep.repeats,
        "runs": runs,
        "ladders": ladders,
    }
    return results, crops


def _plan(sweep: Sweep, splats: float | None) -> list[Run]:
    """Return the pictures of a case."""
    from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES
    from splatline.host.visibility.skips import SKIPS

    presets = sweep.presets if splats is None else sweep.fewer_presets
    runs = [Run(FLOAT), Run(FLOAT_ONE_DEPTH)]
    runs += [Run(quality, preset) for preset in presets for quality in QUALITIES]
    if splats in sweep.sampled:
        runs += [
            Run(quality, preset, samples=samples)
            for preset in presets
            for samples in sweep.samples.get(preset, ())
            for quality in ("paper", DEFAULT_QUALITY)
        ]
    if splats is None:
        runs += [Run(DEFAULT_QUALITY, presets[0], skip) for skip in SKIPS]
    return runs


def _rungs(sweep: Sweep, splats: float | None) -> int:
    """Return the number of pictures of a case's error budget."""
    from splatline.sim.reference.error_budget import LADDERS, ladder

    if splats not in sweep.ladders:
        return 0
    return sum(len(ladder(quality)) for quality in LADDERS)


def _cases(sweep: Sweep) -> Iterator[Case]:
    """Load each cloud once, and draw each case's reference."""
    from splatline.host.shading.lighting import Lighting
    from splatline.plots.bench_pictures import Crops
    from splatline.plots.figure import BACKGROUND
    from splatline.sim import reference

    for pose in poses(sweep.scenes, sweep.paths, sweep.size, sweep.views):
        place = None
        orbit = pose.camera["orbit"]
        for splats in sweep.splats:
            radii = pose.scaled(splats)
            exact = reference.render(
                pose.cloud, pose.view, radii, Lighting(), background=BACKGROUND
            )
            crops = Crops(pose.name, orbit, splats, exact, place)
            place = crops.place  # the same for every size
            yield Case(
                pose.name,
                pose.cloud,
                pose.view,
                pose.camera,
                pose.source,
                splats,
                splats or pose.usual,
                radii,
                exact,
                BACKGROUND,
                crops,
            )


def _draw(case: Case, run: Run, sweep: Sweep) -> dict[str, Any]:
    """Draw and measure what an engine draws."""
    from splatline.cli.options.drawing import Drawing
    from splatline.contract.presets import PRESETS
    from splatline.host.pipeline import total_counts
    from splatline.sim.cycles.cycles import count_cycles
    from splatline.sim.golden.multisample import average
    from splatline.sim.reference import metrics
    from splatline.sim.reference.error_budget import blurred_psnr

    assert run.preset is not None
    config = PRESETS[run.preset]
    frames = _make_frames(case, run, config, sweep.repeats)
    drawn = [_golden(frame, sweep.repeats) for frame in frames]
    picture, seconds = average([raster for raster, _ in drawn]), sum(each for _, each in drawn)
    if run.switched is None:
        case.crops.add(way(run.quality, run.samples), run.preset, picture.to_rgb(case.background))
    stages = total_counts(frames)["seconds"]
    host = sum(value for name, value in stages.items() if name not in ONCE)
    numbers = {
        **case.key,
        **_shown(case),
        **drawing_statistics(
            frames,
            Drawing(picture),
            engine="golden",
            seconds={**stages, "host": host, "golden": seconds},
            stall=0.0,
            seed=0,
        ),
        **metrics.compare(
            picture,
            case.exact,
            background=case.background,
            depth_range=frames[0].counts["depth_range"],
        ),
        "psnr_blurred_db": blurred_psnr(picture.to_rgb(case.background), case.exact.rgb),
    }
    numbers["switched"] = run.switched
    numbers["cycles"] = sum(map(count_cycles, frames))
    numbers["cycles_per_element"] = numbers["cycles"] / numbers["elements"]
    return _rounded(numbers)


def _draw_float(case: Case, run: Run) -> dict[str, Any]:
    """Draw and measure one exact sample a pixel."""
    import time

    from splatline.host.shading.lighting import Lighting
    from splatline.sim.reference.error_budget import measure as measure_error
    from splatline.sim.reference.point_sampled import Steps, render

    steps = Steps() if run.quality == FLOAT else Steps(depth="splat")
    begin = time.perf_counter()
    picture = render(
        case.cloud, case.view, case.radii, Lighting(), steps, background=case.background
    )
    seconds = time.perf_counter() - begin
    case.crops.add(run.quality, None, picture.rgb)
    return _rounded(
        {
            **case.key,
            "quality": run.quality,
            "preset": None,
            "samples": 1,
            **_shown(case),
            "size": [case.view.width, case.view.height],
            "points": len(case.cloud),
            "drawn_pixels": int(picture.drawn.sum()),
            "depth_range": list(picture.depth_range),
            "seconds": {"float": round(seconds, 4)},
            **measure_error(picture, case.exact, case.background),
        }
    )


def _walk(case: Case, sweep: Sweep, advance: Callable[[str], None]) -> Iterator[dict[str, Any]]:
    """Draw up a case's error budget."""
    from splatline.host.shading.lighting import Lighting
    from splatline.sim.reference.error_budget import LADDERS, ladder, walk

    if case.splats not in sweep.ladders:
        return
    for quality in LADDERS:
        rungs = ladder(quality)
        steps = walk(
            rungs, case.cloud, case.view, case.radii, Lighting(), case.exact, case.background
        )
        for rung in rungs:
            advance(f"{case.scene}, {case.splats or 'auto'}: {quality}, {rung.name}")
            yield _rounded({**case.key, "quality": quality, "preset": "paper", **next(steps)})


def _make_frames(case: Case, run: Run, config: EngineConfig, repeats: int) -> list[Frame]:
    """Return the frames of the fastest call; the first, which may have compiled, is left out."""
    from splatline.host.pipeline import make_frames, total_counts
    from splatline.host.shading.materials import find_materials
    from splatline.host.visibility.block_index import build_index
    from splatline.host.visibility.skips import DEFAULT_SKIPS

    skips = DEFAULT_SKIPS if run.switched is None else DEFAULT_SKIPS ^ {run.switched}
    found = find_materials(case.cloud, 1 << config.material_bits)
    index = build_index(case.cloud, case.radii, found)
    calls = [
        make_frames(index, case.view, run.samples, config=config, quality=run.quality, skips=skips)
        for _ in range(repeats + 1)
    ]
    return min(calls[1:], key=lambda frames: sum(total_counts(frames)["seconds"].values()))


def _golden(frame: Frame, repeats: int) -> tuple[Raster, float]:
    """Return the golden renderer's picture, and the seconds of the fastest warm call."""
    import time

    from splatline.sim import golden

    raster = golden.render(frame)
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter()
        raster = golden.render(frame)
        best = min(best, time.perf_counter() - begin)
    return raster, best


def _shown(case: Case) -> dict[str, Any]:
    """Return what was drawn, as the statistics of ``render`` name it."""
    return {
        "cloud": case.source,
        "view": {**case.camera, "orbit": list(case.camera["orbit"])},
        "splat_size": "auto" if case.splats is None else f"{case.splats:g} px",
        "dropped": case.cloud.dropped,
    }


def _rounded(numbers: dict[str, Any]) -> dict[str, Any]:
    """Return numbers without digits that say nothing."""
    return {
        key: float(f"{value:.7g}") if isinstance(value, float) else value
        for key, value in numbers.items()
    }


def _processor() -> str:
    """Return the processor's name where the system tells it."""
    try:
        lines: Sequence[str] = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = ()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def _cores() -> int:
    import os

    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
