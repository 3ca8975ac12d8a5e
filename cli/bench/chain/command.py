"""``splatline bench chain``: speed-up and frame rate of chains, simulated in Verilog."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.bench.options import folder_option, scenes_option
from splatline.cli.bench.subjects import check_names
from splatline.cli.options.outputs import check_folder, lines_of_json, write_text
from splatline.cli.options.parameters import PRESET, SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.cli.report.statistics import tool_versions
from splatline.contract.chain_links import LINKS, MOST_ENGINES
from splatline.contract.config import EngineConfig
from splatline.contract.presets import PRESETS
from splatline.contract.tool_error import ToolFailure

from .measure import Plan, measure

__all__ = ["chain"]

MEASURED_PRESETS = (PRESETS["paper"], PRESETS["rgb24"])


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@scenes_option
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the image.")
@click.option(
    "--elements",
    type=click.IntRange(100),
    default=400_000,
    help="Approximate number of elements a frame.",
)
@click.option(
    "--engines",
    multiple=True,
    type=click.IntRange(1, MOST_ENGINES),
    default=(1, 2, 4, 8),
    show_default="1, 2, 4, 8",
    help="Engines in the chain; may be given several times. One engine is always measured, for the"
    " speed-up.",
)
@click.option(
    "--link",
    "links",
    multiple=True,
    type=click.Choice(LINKS),
    default=LINKS,
    show_default=", ".join(LINKS),
    help="How pictures pass from engine to engine.",
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
@click.option(
    "--clock",
    type=click.FloatRange(1, 1000),
    help="Clock rate for the times, MHz; by default those of paper and rgb24 as routed.",
)
@folder_option("chain.json and chain.md")
def chain(
    clouds: tuple[Path, ...],
    scenes: tuple[str, ...],
    size: tuple[int, int],
    elements: int,
    engines: tuple[int, ...],
    links: tuple[str, ...],
    presets: tuple[EngineConfig, ...],
    clock: float | None,
    out_dir: Path,
) -> None:
    """Measure chains of engines: cycles, latency and frames a second, in Verilator.

    Draws the built-in scenes and any CLOUDs, sampled to about the given number of elements. The
    first one is also seen from so near that it fills the image. Every picture is compared with the
    golden renderer's. Each chain is built once, in half a minute; the whole run takes ten minutes.

    \b
    Examples:
      splatline bench chain
      splatline bench chain --scene knot --engines 1 --engines 8 --link merge --preset paper
      splatline bench chain scan.ply --clock 80 --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.host.scenes.scenes import SCENES
    from splatline.sim.cosim.simulator import SimulationError

    engines = tuple(sorted({1, *engines}))
    plan = Plan(scenes or tuple(SCENES), clouds, size, elements, presets, links, engines)
    check_names(plan.scenes, clouds)
    check_folder(out_dir)
    tell_compiling()
    with Counter(plan.total()) as counter:
        try:
            runs = list(measure(plan, counter.advance))
        except SimulationError as error:
            raise ToolFailure(str(error)) from error
    from splatline.flow.timing.clocks import read_clocks

    from .page import page, rate

    routed = read_clocks()
    clocks = {
        config.name: clock or routed.get(config.name, {}).get("median_mhz") for config in presets
    }
    report = {
        "size": list(size),
        "clock_mhz": clocks,
        "versions": tool_versions("rtl"),
        "runs": rate(runs, clocks),
    }
    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "chain.json", lines_of_json(report))
    write_text(out_dir / "chain.md", text)
    click.echo(text)
    wrong = sum(run["mismatched_pixels"] for run in runs)
    if wrong:
        raise ToolFailure(f"{wrong:,} pixels of the chains' pictures differ from golden's")
