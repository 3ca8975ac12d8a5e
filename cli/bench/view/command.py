"""``splatline bench view``: how smoothly a live view turns."""

from __future__ import annotations

import importlib.util
import os
import tempfile
from pathlib import Path

import click

from splatline.cli.bench.options import folder_option
from splatline.cli.bench.sizes import LARGE
from splatline.cli.options.outputs import check_folder, lines_of_json, write_text
from splatline.cli.options.parameters import SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.contract.errors import InputError, install_hint

__all__ = ["view"]


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the picture.")
@click.option(
    "--points",
    type=click.IntRange(1),
    default=LARGE,
    help="Points of the large cloud, which is resampled from the knot.",
)
@click.option(
    "--seconds", type=click.FloatRange(0.1, 600), default=5.0, help="Time of turning a cloud."
)
@click.option(
    "--steps", type=click.IntRange(2), default=60, help="Single steps whose pictures are timed."
)
@folder_option("view.json and view.md")
def view(
    clouds: tuple[Path, ...],
    size: tuple[int, int],
    points: int,
    seconds: float,
    steps: int,
    out_dir: Path,
) -> None:
    """Measure frames a second and latency of `splatline view`, over a real WebSocket.

    Turns the built-in scenes, the clouds named, and a large cloud.

    \b
    Examples:
      splatline bench view
      splatline bench view scan.ply --seconds 10
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    check_folder(out_dir)
    tell_compiling()
    if importlib.util.find_spec("aiohttp") is None:
        raise InputError(f"bench view needs aiohttp: {install_hint('view')}")
    from splatline.cli.bench.machine import described
    from splatline.host.scenes.scenes import SCENES, load_scene
    from splatline.view.subject import Subject

    from .measure import Cloud, measure_view, write_large
    from .page import write_page

    load = os.getloadavg()[0]
    found = []
    for name in SCENES:
        scene = load_scene(name)
        subject = Subject(scene=name, name=name, orbit=scene.orbit, fov=scene.fov, up=scene.up)
        found.append(Cloud(name, ("--scene", name), subject))
    for path in clouds:
        subject = Subject(path=path, name=path.stem)
        found.append(Cloud(path.stem, (str(path), "--up", "y"), subject))
    with (
        tempfile.TemporaryDirectory(prefix="splatline-") as folder,
        Counter(2 * len(found) + 3) as counter,
    ):
        counter.advance(f"making a cloud of {points:,} points")
        found.append(write_large(Path(folder) / "large.ply", points))
        runs = measure_view(found, size, seconds, steps, counter.advance)
    results = {
        "machine": described("aiohttp"),
        "load": load,
        "size": list(size),
        "seconds": seconds,
        "runs": runs,
    }
    text = write_page(results)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_text(out_dir / "view.json", lines_of_json(results))
    write_text(out_dir / "view.md", text)
    click.echo(text)
