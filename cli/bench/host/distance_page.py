"""Distances on the page of ``splatline bench host``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["by_distance"]


def by_distance(runs: list[dict[str, Any]]) -> list[str]:
    """Return the section on distances; nothing if none was measured."""
    if not runs:
        return []
    counts = list(runs[0]["errors"])
    errors = [head for count in counts for head in (f"PSNR, {count}", f"IoU, {count}")]
    return [
        "",
        "## By distance",
        "",
        f"{runs[0]['cloud']}, from a view that fits it to one from many times as far, quality"
        " `exact`. Times are in milliseconds. PSNR in dB and the silhouette's IoU, with one sample"
        " a pixel and with 16, are against the exact discs of all points with 8 x 8 samples.",
        "",
        table(
            ("times as far", "elements", "project", "host", "golden", "frame", *errors),
            [_row(run, counts) for run in runs],
            0,
        ),
    ]


def _row(run: dict[str, Any], counts: list[str]) -> tuple[str, ...]:
    times = (run["seconds"]["project"], run["host_seconds"], run["seconds"]["golden"],
             run["frame_seconds"])  # fmt: skip
    errors = (run["errors"][count] for count in counts)
    return (
        str(run["distance"]),
        f"{run['elements']:,}",
        *(f"{1e3 * seconds:.1f}" for seconds in times),
        *(cell for error in errors for cell in _cells(error)),
    )


def _cells(error: dict[str, Any]) -> tuple[str, str]:
    psnr, overlap = error["psnr_db"], error["silhouette_iou"]
    return "-" if psnr is None else f"{psnr:.1f}", "-" if overlap is None else f"{overlap:.3f}"
