"""The Markdown page of ``splatline bench configurations``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from splatline.cli.bench.markdown import table

__all__ = ["page"]

_Row = dict[str, Any]


def page(report: dict[str, Any]) -> str:
    """Return the report as Markdown."""
    points, runs = report["points"], report["runs"]
    width, height = report["size"]
    versions = ", ".join(f"{name} {number}" for name, number in report["versions"].items())
    scenes = list(dict.fromkeys((run["scene"], run["splats"]) for run in runs))
    heads = ["engine", "window", "columns", "depth, bits", "lines", "pixels a word"]
    heads += [_scene(*scene) for scene in scenes]
    counted = points[0]["lut4"] is not None
    heads += ["LUTs", "flip-flops", "block RAMs", "fits XC2V250"] if counted else []
    clocked = any(point["ecp5_mhz"] is not None for point in points)
    heads += ["ECP5", "MHz"] if clocked else []
    found = {(run["preset"], run["scene"], run["splats"]): run for run in runs}

    def row(point: _Row) -> Iterable[str]:
        yield from (point["name"], point["window"], f"{point['columns']:,}")
        yield from (f"{point[key]}" for key in ("depth_bits", "window_lines", "pixels_per_word"))
        for scene in scenes:
            yield f"{found[point['name'], *scene]['cycles_per_element']:.3f}"
        if counted:
            yield from (f"{point[kind]:,}" for kind in ("lut4", "ff", "bram"))
            yield "yes" if point["fits"] else "**no**"
        if clocked:
            device, rate = point["ecp5"], point["ecp5_mhz"]
            yield from ("-", "-") if rate is None else (device.rpartition("-6")[0], f"{rate:.1f}")

    totals = (
        [point["name"], *(f"{found[point['name'], *scene]['cycles']:,}" for scene in scenes)]
        for point in points
    )
    text = {"engine", "window", "fits XC2V250", "ECP5"}
    parts = [
        "# Engines compared",
        f"Made by `splatline bench configurations`: {width} x {height} pixels, quality"
        f" {report['quality']}; {versions}. Presets are in `contract/presets.py`, the other engines"
        " in `contract/variants.py`. More bits of depth and columns leave fewer bits for"
        " intensities and materials in the 64-bit code word.",
        "The table has cycles an element for each scene and median diameter of its splats. Cycles"
        " are counted from the first code word of an engine's first frame to its end beat, with the"
        " clearing of the window, by the cycle model of the Verilog. LUTs, flip-flops and block"
        " RAMs are those of Yosys for the paper's Virtex-II, an XC2V250 (3,072 LUTs and flip-flops,"
        " 24 block RAMs).",
        table(heads, map(list, map(row, points)), text),
        "Cycles of the whole frame:",
        table(["engine", *(_scene(*scene) for scene in scenes)], totals, text),
    ]
    if clocked:
        parts[2] += (
            " The clock rate is the median of four seeds, routed on the smallest Lattice ECP5 of"
            " the slowest grade that has enough block RAMs."
        )
    return "\n\n".join(parts) + "\n"


def _scene(name: str, splats: str | float) -> str:
    return f"{name}, {splats if splats == 'auto' else f'{splats:g} px'}"
