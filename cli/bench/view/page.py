"""The page of ``splatline bench view``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["GOALS", "write_page"]

GOALS = {"fps": 30.0, "latency_ms": 80.0}
"""Least frames a second, and most milliseconds of the median latency."""

HEADS = (
    "cloud", "points", "frames/s", "of full size", "latency, ms", "95 %, ms", "processor, ms",
    "drawing alone, ms", "its processor, ms",
)  # fmt: skip


def write_page(results: dict[str, Any]) -> str:
    """Return the results as Markdown."""
    width, height = results["size"]
    rows = [
        (
            row["cloud"],
            f"{row['points']:,}",
            f"{row['fps']:.1f}",
            f"{row['full']:.0%}",
            f"{row['latency_ms']:.1f}",
            f"{row['latency_95_ms']:.1f}",
            "-" if row["processor_ms"] is None else f"{row['processor_ms']:.1f}",
            f"{row['draw_ms']:.1f}",
            f"{row['draw_processor_ms']:.1f}",
        )
        for row in results["runs"]
    ]
    return "\n".join(
        [
            "# The live view",
            "",
            f"Made by `splatline bench view`: {width} x {height} pixels, one sample a pixel,"
            f" quality exact; {results['machine']}. Load average at the start:"
            f" {results['load']:.1f}.",
            "",
            "Server and client are processes of their own, with a WebSocket between them, and raw"
            " pixels on it. Frames a second: the mouse moves 125 times a second with the button"
            " down. A picture that would take longer than 28 ms is drawn coarser; the share of full"
            " size says how many were not. Latency: from a single step of the mouse to its picture"
            " received, the median and 95 %. Processor: time of the server a picture, on all cores"
            " together. Drawing alone: the same pictures in full size without a server, the bound.",
            "",
            table(HEADS, rows, 1),
            "",
            *(_verdict(row) for row in results["runs"]),
            "",
        ]
    )


def _verdict(row: dict[str, Any]) -> str:
    """Return whether a cloud meets the goals."""
    met = row["fps"] >= GOALS["fps"] and row["latency_ms"] < GOALS["latency_ms"]
    return (
        f"- {row['cloud']}: at least {GOALS['fps']:g} frames a second and less than"
        f" {GOALS['latency_ms']:g} ms: {'met' if met else 'missed'}"
    )
