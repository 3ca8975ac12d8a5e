"""The measurements of ``splatline bench accuracy``: times, errors and error budgets of pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from splatline.cli.bench.machine import machine
from splatline.cli.bench.subjects import poses
from splatline.cli.report.statistics import drawing_statistics, tool_versions

from .sweep import FLOAT_DEPTHS, FLOAT_ONE_DEPTH, TWICE, Run, Size, Sweep, budgeted, plan, way

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.config import EngineConfig
    from splatline.contract.frame import Frame
    from splatline.contract.raster import Raster
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View
    from splatline.plots.bench_pictures import Crops
    from splatline.sim.reference.point_sampled import Steps
    from splatline.sim.reference.reference import Reference

__all__ = ["measure"]

REFERENCE_SAMPLES = 8
"""Samples of the reference along a side of a pixel: 4 hide differences near 40 dB."""

ONCE = {"materials", "index"}
"""Stages of the host that run once for each cloud, not for each frame."""


@dataclass
class Case:
    """A cloud, a view and a size of splats, with the reference's picture."""

    scene: str
    cloud: Cloud
    view: View
    camera: dict[str, Any]
    source: str
    splats: Size
    median: float
    radii: npt.NDArray[np.float64]
    exact: Reference
    background: tuple[float, float, float]
    crops: Crops

    @property
    def key(self) -> dict[str, Any]:
        """The values that identify the case."""
        return {
            "scene": self.scene,
            "orbit": list(self.camera["orbit"]),
            "splats": self.splats or "auto",
            "median_pixels": round(self.median, 3),
        }


def measure(sweep: Sweep, advance: Callable[[str], None]) -> tuple[dict[str, Any], list[Crops]]:
    """Measure all pictures of a sweep.

    Parameters
    ----------
    sweep
        The pictures.
    advance
        Called with a description before each picture.

    Returns
    -------
    results
        Ready for JSON: ``machine``, ``tools``, ``runs`` and ``ladders``.
    crops
        Parts of the pictures of each case.
    """
    runs: list[dict[str, Any]] = []
    ladders: list[dict[str, Any]] = []
    crops = []
    for case in _cases(sweep):
        for run in plan(sweep, case.splats):
            several = f", {run.samples} samples" if run.samples > 1 else ""
            what = f"{run.quality} {run.preset or ''}{several}"
            advance(f"{case.scene}, {case.splats or 'auto'}: {what}")
            runs.append(_draw_float(case, run) if run.preset is None else _draw(case, run, sweep))
        ladders += _error_budget(case, sweep, advance)
        crops.append(case.crops)
    # All runs have the same keys; a value that a float quality lacks is null.
    keys = list(dict.fromkeys(key for run in reversed(runs) for key in run))
    runs = [{key: run.get(key) for key in keys} for run in runs]
    results = {
        "machine": machine(),
        "tools": tool_versions("golden"),
        "size": list(sweep.size),
        "reference_samples": REFERENCE_SAMPLES,
        "repeats": sweep.repeats,
        "runs": runs,
        "ladders": ladders,
    }
    return results, crops


def _cases(sweep: Sweep) -> Iterator[Case]:
    """Yield all cases; each cloud is loaded once, and the reference is drawn for each case."""
    from splatline.host.shading.lighting import Lighting
    from splatline.plots.bench_pictures import Crops
    from splatline.plots.figure import BACKGROUND
    from splatline.sim import reference

    for pose in poses(sweep.scenes, sweep.paths, sweep.size, sweep.views):
        part = None
        orbit = pose.camera["orbit"]
        for splats in sweep.splats:
            twice = splats == TWICE
            diameter = None if twice else splats
            radii = 2.0 * pose.radii if twice else pose.scaled(diameter)
            exact = reference.render(
                pose.cloud,
                pose.view,
                radii,
                Lighting(),
                background=BACKGROUND,
                samples=REFERENCE_SAMPLES,
            )
            crops = Crops(pose.name, orbit, splats, exact, part)
            part = crops.part  # the same part of the image for every size of splats
            yield Case(
                pose.name,
                pose.cloud,
                pose.view,
                pose.camera,
                pose.source,
                splats,
                2.0 * pose.usual if twice else diameter or pose.usual,
                radii,
                exact,
                BACKGROUND,
                crops,
            )


def _draw(case: Case, run: Run, sweep: Sweep) -> dict[str, Any]:
    """Draw and measure the picture of an engine."""
    from splatline.cli.options.drawing import Drawing
    from splatline.contract.variants import CONFIGS
    from splatline.host.pipeline import total_counts
    from splatline.sim.cycles.cycles import count_cycles
    from splatline.sim.golden.multisample import average
    from splatline.sim.reference import metrics
    from splatline.sim.reference.error_budget import blurred_psnr

    assert run.preset is not None
    config = CONFIGS[run.preset]
    frames, busy_host = _make_frames(case, run, config, sweep.repeats)
    drawn = [_golden(frame, sweep.repeats) for frame in frames]
    picture = average([raster for raster, _, _ in drawn])
    seconds, busy_golden = (sum(each[part] for each in drawn) for part in (1, 2))
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
    numbers["processor_seconds"] = {
        "host": round(busy_host, 4),
        "golden": round(busy_golden, 4),
    }
    numbers["cycles"] = cycles = sum(map(count_cycles, frames))
    numbers["cycles_per_element"] = cycles / numbers["elements"]
    return _rounded(numbers)


def _draw_float(case: Case, run: Run) -> dict[str, Any]:
    """Draw and measure a picture of a float quality."""
    import time

    from splatline.host.shading.lighting import Lighting
    from splatline.sim.reference.error_budget import measure as measure_error
    from splatline.sim.reference.point_multisample import render_samples

    begin = time.perf_counter()
    picture = render_samples(
        run.samples,
        case.cloud,
        case.view,
        case.radii,
        Lighting(),
        _float_steps(run.quality),
        background=case.background,
    )
    seconds = time.perf_counter() - begin
    case.crops.add(way(run.quality, run.samples), None, picture.rgb)
    return _rounded(
        {
            **case.key,
            "quality": run.quality,
            "preset": None,
            "samples": run.samples,
            **_shown(case),
            "size": [case.view.width, case.view.height],
            "points": len(case.cloud),
            "drawn_pixels": int(picture.drawn.sum()),
            "depth_range": list(picture.depth_range),
            "seconds": {"float": round(seconds, 4)},
            **measure_error(picture, case.exact, case.background),
        }
    )


def _float_steps(quality: str) -> Steps:
    """Return the approximations of a float quality."""
    from splatline.contract.presets import PLANE
    from splatline.sim.reference.point_sampled import Steps

    if quality == FLOAT_ONE_DEPTH:
        return Steps(depth="splat")
    if quality == FLOAT_DEPTHS:
        return Steps(
            depth_bits=PLANE.depth_bits,
            intensity_bits=PLANE.intensity_bits,
            materials=1 << PLANE.material_bits,
            channel_bits=PLANE.channel_bits,
        )
    return Steps()


def _error_budget(
    case: Case, sweep: Sweep, advance: Callable[[str], None]
) -> Iterator[dict[str, Any]]:
    """Yield the steps of a case's error budgets."""
    from splatline.contract.variants import CONFIGS
    from splatline.host.shading.lighting import Lighting
    from splatline.sim.reference.error_budget import ladder, walk

    for run in budgeted(sweep, case.splats):
        assert run.preset is not None
        rungs = ladder(run.quality, CONFIGS[run.preset], run.samples)
        steps = walk(
            rungs, case.cloud, case.view, case.radii, Lighting(), case.exact, case.background,
            run.samples,
        )  # fmt: skip
        name = {"quality": run.quality, "preset": run.preset, "samples": run.samples}
        for rung in rungs:
            what = f"{way(run.quality, run.samples)} {run.preset}, {rung.name}"
            advance(f"{case.scene}, {case.splats or 'auto'}: {what}")
            yield _rounded({**case.key, **name, **next(steps)})


def _make_frames(
    case: Case, run: Run, config: EngineConfig, repeats: int
) -> tuple[list[Frame], float]:
    """Return the frames of the fastest call, and the least processor seconds of a call.

    The first call, which may compile, is left out.
    """
    import time

    from splatline.host.pipeline import make_frames, total_counts
    from splatline.host.shading.materials import find_materials
    from splatline.host.visibility.block_index import build_index
    from splatline.host.visibility.skips import DEFAULT_SKIPS

    skips = DEFAULT_SKIPS if run.switched is None else DEFAULT_SKIPS ^ {run.switched}
    found = find_materials(case.cloud, 1 << config.material_bits)
    index = build_index(case.cloud, case.radii, found)
    calls, busy = [], []
    for _ in range(repeats + 1):
        begin = time.process_time()
        calls.append(
            make_frames(
                index, case.view, run.samples, config=config, quality=run.quality, skips=skips
            )
        )
        busy.append(time.process_time() - begin)
    frames = min(calls[1:], key=lambda frames: sum(total_counts(frames)["seconds"].values()))
    return frames, min(busy[1:])


def _golden(frame: Frame, repeats: int) -> tuple[Raster, float, float]:
    """Return the golden renderer's picture, and the least seconds of a warm call.

    The first number is the time that passed, the second that of the processor's cores together.
    """
    import time

    from splatline.sim import golden

    raster = golden.render(frame)
    best = busy = float("inf")
    for _ in range(repeats):
        begin, begin_busy = time.perf_counter(), time.process_time()
        raster = golden.render(frame)
        best = min(best, time.perf_counter() - begin)
        busy = min(busy, time.process_time() - begin_busy)
    return raster, best, busy


def _shown(case: Case) -> dict[str, Any]:
    """Return the input of a case, with the keys of the statistics of ``render``."""
    return {
        "cloud": case.source,
        "view": {**case.camera, "orbit": list(case.camera["orbit"])},
        "splat_size": case.splats
        if isinstance(case.splats, str)
        else "auto"
        if case.splats is None
        else f"{case.splats:g} px",
        "dropped": case.cloud.dropped,
    }


def _rounded(numbers: dict[str, Any]) -> dict[str, Any]:
    """Return numbers rounded to seven digits."""
    return {
        key: float(f"{value:.7g}") if isinstance(value, float) else value
        for key, value in numbers.items()
    }
