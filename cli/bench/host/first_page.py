"""Times to the first picture on the page of ``splatline bench host``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table
from splatline.cli.bench.sizes import LARGE, MEDIUM

from .first_picture import Kind
from .race_page import EMBREE

__all__ = ["first_pictures"]

START = "start"

GOALS = {
    Kind(LARGE).name: 3.0,
    Kind(1_000_000, noisy=True).name: 2.0,
    Kind(MEDIUM).name: 1.2,
}
"""Most seconds from the command to the picture, by cloud."""

YARDSTICK = (MEDIUM, 0.021)
"""Points of a cloud, and the seconds of Embree's frame of it where the goals were set."""

REASONS = """\
Most of the start are imports: 1.31 s by `python -X importtime`, with 0.66 s for numba and numpy
(measured once, where the start took 1.3 s). Next would be compiled functions that load without
numba; `splatline view` starts once for many pictures.

The first run on a machine compiles for 42 s of processor time (measured once, with an empty
cache). `make setup` does so and says it; after `pip install` the first command does, and says
it."""
"""Parts of the start, and the first run on a machine."""

LEAST = 5e-4
"""Seconds below which a stage is left out, if it is so in every cloud."""


def first_pictures(runs: list[dict[str, Any]], peers: list[dict[str, Any]]) -> list[str]:
    """Return the section on the time to the first picture; nothing if it was not measured.

    Parameters
    ----------
    runs
        Times of the clouds.
    peers
        Frames of other renderers in the same run. Embree's tells how fast the machine is.
    """
    if not runs:
        return []
    slower = _times_slower(peers)
    # The cloud with the most stages first, so that each stage stands where it happens.
    by_stages = sorted(runs, key=lambda run: -len(run["seconds"]))
    names = list(dict.fromkeys(name for run in by_stages for name in run["seconds"]))
    stages = [name for name in names if any(run["seconds"].get(name, 0) >= LEAST for run in runs)]
    rows = [
        ("**wall time**", *(f"**{run['wall']:.2f}**" for run in runs)),
        ("goal", *(_verdict(run["cloud"], run["wall"]) for run in runs)),
        *(
            [("scaled", *(_verdict(run["cloud"], run["wall"] / slower, True) for run in runs))]
            if slower
            else []
        ),
        (START, *(_seconds(run["start"]) for run in runs)),
        *((name, *(_seconds(run["seconds"].get(name)) for run in runs)) for name in stages),
        *((peer, *(_wall(run, peer) for run in runs)) for peer in runs[0]["peers"]),
    ]
    return [
        "",
        "## From the command to the picture",
        "",
        "Seconds of `splatline render FILE -o PNG` in a fresh process, the fastest of three after"
        " one that loads what is on disk into memory. The files are binary PLY with colours."
        " `start` is the time outside of stages: Python, imports and the end of the process."
        " Other renderers run a few lines of Python that read the same file and write a picture of"
        " the same size, with points of 2 pixels. They estimate neither normals nor sizes of"
        " splats. In brackets: their time as a multiple of ours.",
        "",
        table(("stage", *(_head(run) for run in runs)), rows, 1),
        *_scale(slower),
        *(line for run in runs for line in _why_missed(run)),
        "",
        REASONS,
    ]


def _head(run: dict[str, Any]) -> str:
    return f"{run['cloud']}, {run['bytes'] / 1e6:.0f} MB"


def _verdict(cloud: str, wall: float, shows_time: bool = False) -> str:
    """Return the goal of a cloud or its scaled time, and whether the goal is met."""
    goal = GOALS.get(cloud)
    if goal is None:
        return "-"
    return f"{wall if shows_time else goal:.2f}: {'met' if wall <= goal else 'missed'}"


def _times_slower(peers: list[dict[str, Any]]) -> float | None:
    """Return how many times as long Embree takes here as where the goals were set."""
    points, seconds = YARDSTICK
    for peer in peers:
        if peer["peer"] == EMBREE and peer["points"] == points and peer["seconds"] is not None:
            return float(peer["seconds"]) / seconds
    return None


def _scale(slower: float | None) -> list[str]:
    """Return a paragraph on the scaled times."""
    if slower is None:
        return []
    points, seconds = YARDSTICK
    return [
        "",
        f"The goals were set on a machine where Embree draws a frame of {points:,} points in"
        f" {1e3 * seconds:.0f} ms. Here it takes {1e3 * seconds * slower:.1f} ms,"
        f" {slower:.2f} times as long. *Scaled* is the wall time divided by that.",
    ]


def _why_missed(run: dict[str, Any]) -> list[str]:
    """Return a line that says what takes most of the time of a cloud whose goal is missed."""
    goal = GOALS.get(run["cloud"])
    if goal is None or run["wall"] <= goal:
        return []
    parts = {START: run["start"], **run["seconds"]}
    first, second = sorted(parts, key=lambda name: -parts[name])[:2]
    return [
        "",
        f"Of the {run['wall']:.2f} s of {run['cloud']}, {first} takes {parts[first]:.2f} s and"
        f" {second} {parts[second]:.2f} s.",
    ]


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _wall(run: dict[str, Any], name: str) -> str:
    """Return a renderer's time and its ratio to ours, or why there is none."""
    peer = run["peers"].get(name)
    if peer is None:
        return "-"
    wall = peer["wall"]
    return f"{wall:.2f} ({wall / run['wall']:.2f})" if wall is not None else peer["why"]
