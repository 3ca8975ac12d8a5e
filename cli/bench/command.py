"""``splatline bench``: the group of benchmarks, and the command ``accuracy``."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.bench.chain.command import chain
from splatline.cli.bench.configurations.measure import configurations
from splatline.cli.bench.engine.command import engine
from splatline.cli.bench.host.measure import host
from splatline.cli.bench.large.command import large
from splatline.cli.bench.stability.measure import stability
from splatline.cli.bench.surface.command import surface
from splatline.cli.bench.view.command import view
from splatline.cli.options.outputs import check_folder
from splatline.cli.options.parameters import ORBIT, SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter

from .options import folder_option, scenes_option
from .subjects import check_names

__all__ = ["bench"]


ACCURACY_SIZES: dict[str, float | str | None] = {
    "auto": None, "twice": "twice", "1.5": 1.5, "3.5": 3.5, "7": 7.0, "14": 14.0,
}  # fmt: skip
"""Sizes of splats that ``splatline bench accuracy`` measures, by their names."""


@click.group()
def bench() -> None:
    """Run benchmarks; write their results as JSON, tables and plots.

    \b
    Examples:
      splatline bench accuracy                  every quality and preset against the reference
      splatline bench chain                     chains of engines, simulated in Verilog
      splatline bench configurations            engines of other windows, widths and depths
      splatline bench engine                    clock cycles of frames, beside the lower bound
      splatline bench host                      rates of the host's stages, beside other renderers
      splatline bench large                     100 million points, COPC and Dask
      splatline bench stability                 the stress suite
      splatline bench surface                   holes and errors against the true surface
      splatline bench view                      frames a second and latency of the live view
    """  # noqa: D301  (click reads the backspace as "do not wrap")


@bench.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@scenes_option
@click.option(
    "--view",
    "views",
    multiple=True,
    type=ORBIT,
    metavar="AZ,EL",
    show_default="the scene's, or 30,20",
    help="Azimuth and elevation of the eye in degrees; may be given several times.",
)
@click.option("--size", type=SIZE, metavar="WxH", default=None, show_default="512x512",
              help="Size of the image in pixels.")  # fmt: skip
@click.option("--splats", "sizes", multiple=True, default=ACCURACY_SIZES, show_default="all",
              type=click.Choice(list(ACCURACY_SIZES)),
              help="Size of the splats: auto, the points' own spacing; twice, twice as large; or"
              " the median diameter in pixels. May be given several times.")  # fmt: skip
@folder_option("accuracy.json, accuracy.md and the plots")
@click.option(
    "--no-pictures",
    "unseen",
    multiple=True,
    metavar="NAME",
    help="Leave out the pictures of this cloud, if its terms forbid them; may be given several"
    " times.",
)
@click.option("--quick", is_flag=True, help="A small image and few runs, as a trial.")
def accuracy(
    clouds: tuple[Path, ...],
    scenes: tuple[str, ...],
    views: tuple[tuple[float, float], ...],
    size: tuple[int, int] | None,
    sizes: tuple[str, ...],
    out_dir: Path,
    unseen: tuple[str, ...],
    quick: bool,
) -> None:
    """Measure every quality, preset and skip against the exact reference.

    Measures times, code words, cycles and errors of the built-in scenes and of any CLOUDs. Splats
    have the size of the points' spacing, and several sizes in pixels.

    \b
    Examples:
      splatline bench accuracy
      splatline bench accuracy scan.ply --view 30,20 --view -120,5 --out-dir build/bench
      splatline bench accuracy scan.ply --splats auto --splats twice
      splatline bench accuracy --scene knot --quick --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.cli.bench.accuracy.measure import measure
    from splatline.cli.bench.accuracy.sweep import Sweep
    from splatline.cli.bench.accuracy.write import write_accuracy
    from splatline.contract.errors import InputError
    from splatline.host.scenes.scenes import SCENES

    names = check_names(scenes or tuple(SCENES), clouds)
    for name in unseen:
        if name not in names:
            raise InputError(f"no pictures of {name!r} to leave out; there are: {', '.join(names)}")
    check_folder(out_dir)
    tell_compiling()
    splats = tuple(ACCURACY_SIZES[name] for name in dict.fromkeys(sizes))
    sweep = Sweep(clouds, scenes or SCENES, views, size or (512, 512), splats)
    if quick:
        sweep = Sweep(
            clouds,
            scenes or SCENES[-1:],
            views,
            size or (64, 64),
            splats=(None, 3.5),
            presets=("paper", "rgb24", "plane"),
            fewer_presets=("paper",),
            ladders=(None,),
            sampled=(None, 3.5),
            samples={"paper": (4,)},
            repeats=1,
        )
    with Counter(sweep.total()) as counter:
        results, crops = measure(sweep, counter.advance)
    shown = [crop for crop in crops if crop.scene not in unseen]
    files = write_accuracy(out_dir, results, shown)
    click.echo(f"{len(results['runs'])} runs; written: {', '.join(map(str, files))}")


for _command in (chain, configurations, engine, host, large, stability, surface, view):
    bench.add_command(_command)
