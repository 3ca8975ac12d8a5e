"""The Markdown page of ``splatline bench host``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

from .distance_page import by_distance
from .first_page import first_pictures
from .race_page import rivals

__all__ = ["page"]

WORDS = {"cloud", "quality", "view", "left out"}
"""Columns that are text."""


def page(report: dict[str, Any]) -> str:
    """Return the report as Markdown."""
    width, height = report["size"]
    versions = ", ".join(f"{name} {number}" for name, number in report["versions"].items())
    parts = [
        "# Rates of the host",
        "",
        f"Made by `splatline bench host`: {width} x {height} pixels, preset {report['preset']},"
        f" {report['cores']} cores, {versions}. Times are the fastest of several frames,"
        " with the cloud in memory and its index built. Host is the time from points to sorted code"
        " words, golden that of drawing them.",
        "",
        "## A frame, in milliseconds",
        "",
        table(
            (
                *("cloud", "quality", "elements", "project", "encode", "sort", "host"),
                *("M points/s", "golden", "M words/s", "frame"),
            ),
            [_frame(run) for run in report["runs"] if run["view"] == "whole"],
            WORDS,
        ),
        "",
        "## The index, built once a cloud",
        "",
        table(
            ("cloud", "points", "palette, ms", "index, ms", "bytes a point"),
            _indices(report["runs"]),
            WORDS,
        ),
        "",
        "## Views of the large cloud",
        "",
        "Times of host and golden in milliseconds. They depend on the visible part of the cloud.",
        "",
        table(
            ("view", "quality", "elements", "left out", "host", "golden", "frame"),
            [_seen(run) for run in report["runs"] if run["cloud"] == report["runs"][-1]["cloud"]],
            WORDS,
        ),
    ]
    parts += by_distance(report["distances"])
    parts += rivals(report["peers"]) + first_pictures(report["first_pictures"], report["peers"])
    return "\n".join(parts) + "\n"


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f}"


def _frame(run: dict[str, Any]) -> tuple[str, ...]:
    stages = run["seconds"]
    return (
        run["cloud"],
        run["quality"],
        f"{run['elements']:,}",
        *(_ms(stages[name]) for name in ("project", "encode", "sort")),
        _ms(run["host_seconds"]),
        f"{run['points_per_second'] / 1e6:.1f}",
        _ms(stages["golden"]),
        f"{run['golden_words_per_second'] / 1e6:.1f}",
        _ms(run["frame_seconds"]),
    )


def _indices(runs: list[dict[str, Any]]) -> list[tuple[str, ...]]:
    rows = {
        run["cloud"]: (
            run["cloud"],
            f"{run['points']:,}",
            _ms(run["palette_seconds"]),
            _ms(run["index_seconds"]),
            f"{run['index_bytes_per_point']:.1f}",
        )
        for run in runs
    }
    return list(rows.values())


def _seen(run: dict[str, Any]) -> tuple[str, ...]:
    culled = (f"{name} {count:,}" for name, count in run["culled"].items() if count)
    return (
        run["view"],
        run["quality"],
        f"{run['elements']:,}",
        ", ".join(culled).replace("_", " "),
        _ms(run["host_seconds"]),
        _ms(run["seconds"]["golden"]),
        _ms(run["frame_seconds"]),
    )
