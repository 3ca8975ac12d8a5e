"""Measures live views: frames a second, latency, processor time, beside the drawing alone."""

from __future__ import annotations

import asyncio
import dataclasses
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from splatline.cli.bench.host.first_picture import write_ply
from splatline.host.cloud.resample import resample
from splatline.view.draw import draw
from splatline.view.subject import Subject

from .client import Page, open_page
from .server import Server, running_view

__all__ = ["Cloud", "measure_view", "write_large"]

PAUSE = 0.05
"""Seconds between the single steps whose pictures are timed."""

A_TURN = 2.0
"""Degrees between two pictures that are drawn for the bound."""


class Cloud(NamedTuple):
    """A cloud that is looked at: its name, the arguments of the command, and how it is read."""

    name: str
    arguments: tuple[str, ...]
    subject: Subject


def write_large(path: Path, points: int) -> Cloud:
    """Write the knot with so many points, as ``splatline bench host`` makes it."""
    live = Subject(scene="knot", name="knot", orbit=(-8.0, 8.0), fov=30.0).read(None)
    large, _ = resample(live.cloud, live.discs.radii, points)
    write_ply(path, large.positions, large.normals, large.colours)
    subject = Subject(path=path, name=f"knot, {points:,} points", orbit=(-8.0, 8.0), fov=30.0)
    view = ("--orbit", "-8,8", "--fov", "30")
    return Cloud(subject.name, (str(path), *view), subject)


def measure_view(
    clouds: list[Cloud],
    size: tuple[int, int],
    seconds: float,
    steps: int,
    announce: Callable[[str], None],
) -> list[dict[str, Any]]:
    """Return what was measured of each cloud.

    Parameters
    ----------
    clouds
        What is looked at.
    size
        Width and height of the picture.
    seconds
        Time of turning.
    steps
        Single steps whose pictures are timed.
    announce
        Called with a description before each cloud.

    Returns
    -------
    list of dict
        ``cloud``, ``points``; of turning: ``fps``, ``full`` (share of pictures of the full size),
        ``side`` (median width); ``processor_ms``: of the server, a picture; ``latency_ms`` and
        ``latency_95_ms``: from an event to its picture received; ``draw_ms`` and
        ``draw_processor_ms``: of a picture of the full size, drawn alone in this process, median.
    """
    rows = []
    for cloud in clouds:
        announce(f"{cloud.name}: live view")
        with running_view(cloud.arguments) as server:
            served = asyncio.run(_served(server, size, seconds, steps))
        announce(f"{cloud.name}: drawing alone")
        rows.append({"cloud": cloud.name, **served, **_drawn(cloud, size, steps)})
    return rows


async def _served(
    server: Server, size: tuple[int, int], seconds: float, steps: int
) -> dict[str, Any]:
    """Return what a page sees of a live view."""

    async def use(page: Page) -> dict[str, Any]:
        await page.start(size)
        await page.turn(min(1.0, seconds))  # what is compiled or measured first
        before = server.processor_seconds()
        turned = await page.turn(seconds)
        after = server.processor_seconds()
        latencies = [1e3 * latency for latency in await page.steps(steps, PAUSE)]
        processor = None if before is None or after is None else 1e3 * (after - before)
        return {
            "fps": len(turned.times) / seconds,
            "full": sum(width == size[0] for width in turned.widths) / len(turned.widths),
            "side": statistics.median(turned.widths),
            "processor_ms": processor and processor / len(turned.times),
            "latency_ms": statistics.median(latencies),
            "latency_95_ms": statistics.quantiles(latencies, n=20)[-1],
        }

    found: dict[str, Any] = await open_page(server.address, use)
    return found


def _drawn(cloud: Cloud, size: tuple[int, int], repeats: int) -> dict[str, Any]:
    """Return the times of drawing alone, and the points."""
    live = cloud.subject.read(None)
    camera = cloud.subject.home(live, size).rounded()
    walls, processor = [], []
    for number in range(repeats + 2):
        moved = dataclasses.replace(camera, azimuth=camera.azimuth + A_TURN * number)
        start, began = time.perf_counter(), time.process_time()
        _ = draw(live, moved, size).rgba
        if number >= 2:  # the first ones build the index and load compiled code
            walls.append(1e3 * (time.perf_counter() - start))
            processor.append(1e3 * (time.process_time() - began))
    return {
        "points": len(live.cloud),
        "draw_ms": statistics.median(walls),
        "draw_processor_ms": statistics.fmean(processor),
    }
