"""``splatline bench surface``: what a person sees of a surface, by the density of its points."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.bench.options import folder_option
from splatline.cli.options.outputs import check_folder, write_json, write_text
from splatline.cli.options.parameters import PRESET, SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.cli.report.statistics import tool_versions
from splatline.contract.config import EngineConfig
from splatline.contract.presets import DEFAULT

__all__ = ["surface"]

DENSITIES = (0.1, 0.3, 1.0, 3.0, 10.0, 40.0)
"""Points a pixel of the surface that is seen."""

NOISES = (0.0, 0.5, 2.0)
"""Standard deviation of the noise along the normal, in spacings of the points."""


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@click.option("--size", type=SIZE, metavar="WxH", default=None, show_default="256x256",
              help="Size of the image of the scenes in pixels; clouds have 512x512.")  # fmt: skip
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine to draw for.")
@folder_option("surface.json, surface.md and surface.png")
@click.option("--quick", is_flag=True, help="A small image and few densities, as a trial.")
def surface(
    clouds: tuple[Path, ...],
    size: tuple[int, int] | None,
    preset: EngineConfig,
    out_dir: Path,
    quick: bool,
) -> None:
    """Measure pinholes, see-through pixels and errors against the true surface.

    The built-in scenes are sampled at several densities, evenly and at random, with noise along
    the normal, with normals and without, and compared with the true surface. Of a CLOUD there is no
    truth; its pinholes and see-through pixels are counted.

    \b
    Examples:
      splatline bench surface
      splatline bench surface scan.ply --out-dir build/bench
      splatline bench surface --quick --out-dir build/bench
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.contract.errors import InputError
    from splatline.plots.surface_plot import plot_surface

    from .measure import MANY, Sweep, measure_clouds, measure_scenes
    from .page import page

    missing = [path for path in clouds if not path.is_file()]
    if missing:
        raise InputError(f"{missing[0]}: no such file")
    check_folder(out_dir)
    tell_compiling()
    sweep = Sweep(size or (256, 256), preset, DENSITIES, NOISES)
    many: tuple[int, ...] = MANY
    if quick:
        sweep = Sweep(size or (64, 64), preset, (0.3, 1.0, 3.0), (0.0, 0.5))
        many = (10_000,)
    with Counter(sweep.total() + len(clouds)) as counter:
        truths, runs = measure_scenes(sweep, counter.advance)
        scans = measure_clouds(clouds, many, preset, counter.advance)
    report = {
        "size": list(sweep.size),
        "preset": preset.name,
        "versions": tool_versions("golden"),
        "truths": truths,
        "runs": runs,
        "clouds": scans,
    }
    from splatline.contract.atomic_write import atomic_write

    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_json(out_dir / "surface.json", report)
    write_text(out_dir / "surface.md", text)
    atomic_write(out_dir / "surface.png", plot_surface(runs))
    click.echo(text)
