"""Times to the first picture on the page of ``splatline bench host``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["first_pictures"]

START = "start"

LEAST = 5e-4
"""Seconds below which a stage is left out, if it is so in every cloud."""


def first_pictures(runs: list[dict[str, Any]]) -> list[str]:
    """Return the section on the time to the first picture; nothing if it was not measured."""
    if not runs:
        return []
    # The cloud with the most stages first, so that each stage stands where it happens.
    by_stages = sorted(runs, key=lambda run: -len(run["seconds"]))
    names = list(dict.fromkeys(name for run in by_stages for name in run["seconds"]))
    stages = [name for name in names if any(run["seconds"].get(name, 0) >= LEAST for run in runs)]
    rows = [
        ("**wall time**", *(f"**{run['wall']:.2f}**" for run in runs)),
        (START, *(_seconds(run["start"]) for run in runs)),
        *((name, *(_seconds(run["seconds"].get(name)) for run in runs)) for name in stages),
        *((peer, *(_wall(run["peers"].get(peer)) for run in runs)) for peer in runs[0]["peers"]),
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
        " splats.",
        "",
        table(("stage", *(_head(run) for run in runs)), rows, 1),
    ]


def _head(run: dict[str, Any]) -> str:
    return f"{run['cloud']}, {run['bytes'] / 1e6:.0f} MB"


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _wall(peer: dict[str, Any] | None) -> str:
    if peer is None:
        return "-"
    return f"{peer['wall']:.2f}" if peer["wall"] is not None else peer["why"]
