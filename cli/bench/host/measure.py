"""``splatline bench host``: rates of host and golden renderer, beside other renderers."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from splatline.cli.bench.options import folder_option
from splatline.cli.bench.statistics import tool_versions
from splatline.cli.options.outputs import check_folder, write_json, write_text
from splatline.cli.options.parameters import PRESET, SIZE
from splatline.contract.presets import DEFAULT

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.contract.config import EngineConfig
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.block_index import Index
    from splatline.host.visibility.view import View

__all__ = ["host"]

STAGES = ("tables", "project", "encode", "sort", "golden")

VIEWS: dict[str, tuple[float, tuple[str, ...]]] = {
    "whole": (1.0, ()),
    "whole, what is hidden skipped": (1.0, ("hidden",)),
    "whole, crowds thinned": (1.0, ("crowded",)),
    "from ten times as far": (0.1, ()),
    "from ten times as far, crowds thinned": (0.1, ("crowded",)),
    "a corner, 8 times as near": (8.0, ()),
    "a corner, 30 times as near": (30.0, ()),
}
"""Views of the large cloud: magnification, and skips in addition to the default ones."""


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the image.")
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine to draw for.")
@click.option(
    "--points",
    type=click.IntRange(1),
    default=4_000_000,
    help="Points of the large cloud, which is resampled from the last cloud named, or the knot.",
)
@click.option("--repeats", type=click.IntRange(1), default=10, help="Frames; the fastest counts.")
@click.option("--peers/--no-peers", default=True, help="Measure other renderers too.")
@folder_option("host.json and host.md")
def host(
    clouds: tuple[Path, ...],
    size: tuple[int, int],
    preset: EngineConfig,
    points: int,
    repeats: int,
    peers: bool,
    out_dir: Path,
) -> None:
    """Measure the rates of the host's stages, and of other renderers in the same run.

    Draws the built-in scenes, the clouds named, and a large cloud in several views. The other
    renderers are measured if they are installed: pip install '.[peers]'.

    \b
    Examples:
      splatline bench host
      splatline bench host scan.ply --points 10000000
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    check_folder(out_dir)
    from rich.console import Console
    from rich.progress import Progress

    from .peers import PEERS

    runs: list[dict[str, Any]] = []
    rivals: list[dict[str, Any]] = []
    with Progress(console=Console(stderr=True)) as progress:
        subjects = _subjects(clouds, size)
        steps = 2 * len(subjects) + 2 * len(VIEWS) + (2 * len(PEERS) if peers else 0)
        task = progress.add_task("Measuring", total=steps)
        for cloud, view, radii in subjects:
            index, facts = _built(cloud, radii)
            for quality in ("fast", "exact"):
                progress.update(task, description=f"{cloud.name}, {quality}")
                run = _measure(index, view, quality, (), preset, repeats)
                runs.append({"cloud": cloud.name, "view": "whole", **facts, **run})
                progress.advance(task)
        cloud, view, radii = subjects[-1]
        progress.update(task, description=f"Sampling {points:,} points")
        from splatline.host.cloud.resample import resample

        large, small = resample(cloud, radii, points)
        index, facts = _built(large, small)
        for name, (zoom, skips) in VIEWS.items():
            near = _nearer(view, zoom)
            for quality in ("fast", "exact"):
                progress.update(task, description=f"{large.name}, {name}")
                run = _measure(index, near, quality, skips, preset, max(3, repeats // 2))
                runs.append({"cloud": large.name, "view": name, **facts, **run})
                progress.advance(task)
        for what in (subjects[-1], (large, view, small)) if peers else ():
            ours = next(run for run in runs if run["cloud"] == what[0].name)
            for name, draw in PEERS.items():
                progress.update(task, description=f"{what[0].name}, {name}")
                rivals.append({"cloud": what[0].name, "peer": name, **_race(draw, what, ours)})
                progress.advance(task)
    report = {
        "size": list(size),
        "preset": preset.name,
        "cores": len(os.sched_getaffinity(0)),
        "versions": tool_versions("golden"),
        "runs": runs,
        "peers": rivals,
    }
    from .page import page

    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_json(out_dir / "host.json", report)
    write_text(out_dir / "host.md", text)
    click.echo(text)


def _subjects(
    clouds: tuple[Path, ...], size: tuple[int, int]
) -> list[tuple[Cloud, View, npt.NDArray[np.float64]]]:
    """Return cloud, view and radii of each scene and cloud file."""
    from splatline import host as library

    found = []
    for name in ("terrain", "knot"):
        scene = library.load_scene(name)
        view = library.fit_view(
            scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, zoom=scene.zoom, size=size
        )
        found.append((scene.cloud, view, library.splat_radii(scene.cloud)))
    for path in clouds:
        cloud = library.read_cloud(path)
        found.append((cloud, library.fit_view(cloud, size=size), library.splat_radii(cloud)))
    return found


def _built(cloud: Cloud, radii: npt.NDArray[np.float64]) -> tuple[Index, dict[str, float]]:
    """Return a cloud's index, with the time and memory that it took."""
    from splatline.host.shading.materials import find_materials
    from splatline.host.visibility.block_index import build_index

    palette_seconds, materials = _best(lambda: find_materials(cloud), 2)
    index_seconds, index = _best(lambda: build_index(cloud, radii, materials), 2)
    return index, {
        "points": len(index),
        "palette_seconds": palette_seconds,
        "index_seconds": index_seconds,
        "index_bytes_per_point": index.nbytes / len(index),
    }


def _measure(
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


def _nearer(view: View, zoom: float) -> View:
    """Return a view with its focal length multiplied by a factor."""
    import dataclasses

    return dataclasses.replace(view, focal=view.focal * zoom)


def _race(
    draw: Callable[..., float], what: tuple[Any, ...], ours: dict[str, Any]
) -> dict[str, Any]:
    """Return a peer's seconds a frame and their ratio to ours, or the reason of its failure."""
    try:
        seconds = draw(*what)
    except ModuleNotFoundError as error:
        return {"seconds": None, "why": f"{error.name} is not installed"}
    except Exception as error:  # a peer may fail in any way without stopping the benchmark
        return {"seconds": None, "why": f"{type(error).__name__}: {error}"[:200]}
    return {"seconds": seconds, "ratio": seconds / ours["frame_seconds"]}


def _best(work: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least time of several calls in seconds, and the last result."""
    least, result = float("inf"), None
    for _ in range(repeats):
        begin = time.perf_counter()
        result = work()
        least = min(least, time.perf_counter() - begin)
    return least, result
