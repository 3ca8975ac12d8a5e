"""The Markdown page of ``splatline bench engine``."""

from __future__ import annotations

from typing import Any

from splatline.cli.bench.markdown import table

from .few_elements import PIXELS
from .targets import LEAST_RATE, TARGETS, Target

__all__ = ["page"]

FEW = ("elements", "codewords", "raster_words", "cycles")


def page(report: dict[str, Any]) -> str:
    """Return the report as Markdown."""
    runs = report["runs"]
    width, height = report["size"]
    versions = ", ".join(f"{name} {number}" for name, number in report["versions"].items())
    parts = [
        "# Clock cycles of the engine",
        f"Made by `splatline bench engine`: {width} x {height} pixels; {versions}. Cycles are"
        " counted from the first code word of an engine's first frame to its end beat, by the cycle"
        " model of the Verilog. The bound is the fewest cycles that the engine's memory allows for"
        " the same frame: its lanes, the lines of its window, and one raster beat a cycle. Rates"
        f" are at {report['clock_hz'] / 1e6:g} MHz.",
        "## Targets",
        "The worst run for each target. The size of splats is the median diameter.",
        table(
            ("target", "preset", "limit", "worst", "of", "runs that meet it", "met"),
            (_verdict(row) for row in report["targets"]),
            words={"target", "preset", "of", "met"},
        ),
    ]
    rated = any(run["lut4"] is not None for run in runs)
    if report["rates"]:
        parts += [
            f"Elements a second per LUT, quality `fast`, splats of 2 to 4 pixels. The target is"
            f" {LEAST_RATE:,}; the paper's engine has 11,600.",
            table(
                ("preset", "LUTs", "most", "of", "median", "least", f"runs of {LEAST_RATE:,}"),
                map(_rate, report["rates"]),
                words={"preset", "of"},
            ),
        ]
    heads = (
        *("scene", "splats, px", "quality", "elements", "code words", "cycles", "an element"),
        *("a code word", "bound", "ratio", "raster words", "M elements/s"),
        *(("elements/s of a LUT",) if rated else ()),
    )
    for preset in dict.fromkeys(run["preset"] for run in runs):
        rows = [run for run in runs if run["preset"] == preset]
        luts = rows[0]["lut4"]
        parts.append(f"## Preset {preset}" + (f", {luts:,} LUTs" if rated else ""))
        cells = (_cells(run)[: len(heads)] for run in rows)
        parts.append(table(heads, cells, words={"scene", "splats, px", "quality"}))
    parts += [
        "## Few elements",
        f"Splats of {PIXELS:g} pixels at random positions. The frame is not the engine's first one,"
        " which would wait for the clearing of the window.",
        table(
            ("preset", "elements", "code words", "raster words", "cycles"),
            ((row["preset"], *(f"{row[key]:,}" for key in FEW)) for row in report["few"]),
            words={"preset"},
        ),
    ]
    return "\n\n".join(parts) + "\n"


def _rate(row: dict[str, Any]) -> tuple[str, ...]:
    """Return the cells of a preset's rates."""
    figures = (f"{row[key]:,}" for key in ("median", "least"))
    met = f"{row['runs_met']} of {row['runs']}"
    return row["preset"], f"{row['lut4']:,}", f"{row['most']:,}", row["scene"], *figures, met


def _verdict(row: dict[str, Any]) -> tuple[str, ...]:
    target = TARGETS[row["target"]]
    bound = "under" if target.below else "at most"
    return (
        _name(target),
        row["preset"],
        f"{bound} {target.limit:g}",
        f"{row['figure']:.3f}",
        f"{row['scene']}, {row['splats']}, {row['quality']}",
        f"{row['runs_met']} of {row['runs']}",
        "yes" if row["met"] else "**no**",
    )


def _name(target: Target) -> str:
    """Return the name of a target: the limited figure, and the runs that count."""
    where = [target.quality] if target.quality else []
    where += [f"{target.pixels[0]:g} to {target.pixels[1]:g} px"] if target.pixels else []
    return f"{target.meaning}: {', '.join(where) or 'all'}"


def _cells(run: dict[str, Any]) -> tuple[str, ...]:
    auto = run["splats"] == "auto"
    return (
        run["scene"],
        f"auto ({run['median_pixels']:.1f})" if auto else f"{run['splats']:g}",
        run["quality"],
        f"{run['elements']:,}",
        f"{run['codewords']:,}",
        f"{run['cycles']:,}",
        f"{run['cycles_per_element']:.3f}",
        f"{run['cycles_per_codeword']:.3f}",
        f"{run['bound_cycles']:,}",
        f"{run['ratio']:.3f}",
        f"{run['raster_words']:,}",
        f"{run['elements_per_second'] / 1e6:.1f}",
        "-" if run["lut4"] is None else f"{run['elements_per_second_per_lut']:,}",
    )
