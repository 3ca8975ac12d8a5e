"""The page of ``splatline bench large``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["write_page"]

MOST_SECONDS, MOST_BYTES = 60.0, 2 << 30
"""Goals for 100 million points."""

MOST_OF_OCTREE = 5.0

GOAL_POINTS = 100_000_000
"""Points for which the goals are."""


def write_page(results: dict[str, Any]) -> str:
    """Return the page in Markdown."""
    runs = [
        ("decompress it, every field", "laspy and lazrs alone", results["decompress"]),
        ("read coordinates and colours", "`host.large`", results["read"]),
        ("draw it", f"`splatline render --memory {results['memory']}`", results["render"]),
        ("draw its COPC", "the same", results["copc"]),
        ("draw it on all cores", "`--dask local`", results["dask"]),
    ]
    rows = [
        [
            what,
            how,
            f"{run['seconds']:.1f}",
            f"{run['user']:.1f}",
            f"{results['points'] / run['seconds'] / 1e6:.1f}",
            f"{run['peak'] / 2**30:.2f}",
        ]
        for what, how, run in runs
        if run is not None
    ]
    heads = ["", "by", "seconds", "of processors", "million points a second", "memory, GB"]
    width, height = results["size"]
    paragraphs = [
        "# Clouds larger than the memory",
        f"Made by `splatline bench large`. {results['machine']}. A LAZ file of"
        f" {results['points']:,} points with colours, {results['bytes'] / 2**20:,.0f} MB, made by"
        " `cli/bench/large/make_scan.py`: the built-in terrain as an aeroplane scans it, with"
        f" noise. The picture has {width} x {height} pixels, preset `{results['preset']}`. Each"
        " row is a fresh process, from the command to its end. What is compiled on first use was"
        " compiled before.",
        table(heads, rows, 2),
        "\n".join(f"- {line}" for line in _goals(results)),
        _details(results),
    ]
    return "\n\n".join(paragraphs) + "\n"


def _goals(results: dict[str, Any]) -> list[str]:
    """Return a line for each goal."""
    render, read, decompress = results["render"], results["read"], results["decompress"]
    share = read["seconds"] / decompress["seconds"]
    lines = [
        f"Reading takes {share:.2f} times as long as lazrs alone (goal 1: {_met(share <= 1.0)})."
    ]
    if results["points"] >= GOAL_POINTS:
        fast, small = render["seconds"] <= MOST_SECONDS, render["peak"] <= MOST_BYTES
        lines.append(
            f"Drawing takes {render['seconds']:.1f} s (goal 60 s: {_met(fast)}) and"
            f" {render['peak'] / 2**30:.2f} GB (goal 2 GB: {_met(small)})."
        )
        if results["copc"] is not None:
            seconds = results["copc"]["seconds"]
            lines.append(
                f"From COPC it takes {seconds:.1f} s (goal 5 s: {_met(seconds <= MOST_OF_OCTREE)})."
            )
    if results["same"] is not None:
        same = "the same, byte for byte" if results["same"] else "**another one**"
        lines.append(f"Dask's picture is {same}.")
    return lines


def _met(good: bool) -> str:
    """Return whether a goal is met, in words."""
    return "met" if good else "**not met**"


def _details(results: dict[str, Any]) -> str:
    """Return what was left out, and what travelled."""
    dropped = results["render"]["stats"]["dropped"]
    lines = [
        f"Of {results['points']:,} points {dropped.get('finer', 0):,} are finer than the cells of"
        f" the view and are drawn with others, {dropped.get('outside', 0):,} lie outside.",
    ]
    if results["copc"] is not None:
        octree = results["copc"]["stats"]["dropped"]
        reasons = ", ".join(f"{number:,} {reason}" for reason, number in octree.items() if number)
        lines.append(f"From COPC: {reasons}.")
    stats = results["dask"]["stats"]
    pixels = results["render"]["stats"]["drawn_pixels"]
    sent = f"{stats['dask_bytes']:,} bytes of code words in {stats['dask_tasks']} tasks"
    lines.append(
        f"On Dask {stats['parts']} parts were drawn: {sent}"
        f", for a picture of {pixels:,} pixels drawn. The table's memory is that of the command"
        " alone, not of the workers."
    )
    return " ".join(lines)
