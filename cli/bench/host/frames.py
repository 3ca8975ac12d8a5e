"""Times of our own frames: the index of a cloud, then host and golden renderer."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.config import EngineConfig
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.block_index import Index
    from splatline.host.visibility.view import View

__all__ = ["STAGES", "build", "draw_frames"]

STAGES = ("tables", "project", "encode", "sort", "golden")


def build(cloud: Cloud, radii: npt.NDArray[np.float64]) -> tuple[Index, dict[str, float]]:
    """Return a cloud's index, with the time and memory that it took."""
    from splatline.host.shading.materials import find_materials
    from splatline.host.visibility.block_index import build_index

    palette_seconds, materials = _best(lambda: find_materials(cloud), 2)
    # A new cloud each time, since one keeps its points' order along the curve.
    index_seconds, index = _best(
        lambda: build_index(dataclasses.replace(cloud), radii, materials), 2
    )
    return index, {
        "points": len(index),
        "palette_seconds": palette_seconds,
        "index_seconds": index_seconds,
        "index_bytes_per_point": index.nbytes / len(index),
    }


def draw_frames(
    index: Index,
    view: View,
    quality: str,
    skips: tuple[str, ...],
    preset: EngineConfig,
    repeats: int,
) -> dict[str, Any]:
    """Return a frame's counts and times; each time is the least of several runs."""
    from splatline.host.pipeline import make_frame
    from splatline.host.visibility.skips import DEFAULT_SKIPS
    from splatline.sim import golden

    def draw() -> Any:
        begin = time.perf_counter()
        frame = make_frame(
            index, view, quality=quality, config=preset, skips=DEFAULT_SKIPS | set(skips)
        )
        middle = time.perf_counter()
        golden.render(frame)
        end = time.perf_counter()
        stages = {**frame.counts["seconds"], "golden": end - middle}
        return frame, middle - begin, end - begin, stages

    draw()  # compiles, or loads the compiled code
    runs = [draw() for _ in range(repeats)]
    frame = runs[0][0]
    host_seconds = min(run[1] for run in runs)
    stages = {name: min(run[3][name] for run in runs) for name in STAGES}
    words = len(frame.codewords)
    return {
        "quality": quality,
        "skips": frame.counts["skips"],
        "culled": frame.counts["culled"],
        "elements": frame.counts["elements"],
        "codewords": words,
        "seconds": stages,
        "host_seconds": host_seconds,
        "frame_seconds": min(run[2] for run in runs),
        "points_per_second": len(index) / host_seconds,
        "golden_words_per_second": words / stages["golden"],
    }


def _best(work: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least time of several calls in seconds, and the last result."""
    least, result = float("inf"), None
    for _ in range(repeats):
        begin = time.perf_counter()
        result = work()
        least = min(least, time.perf_counter() - begin)
    return least, result
