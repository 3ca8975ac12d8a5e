"""``splatline bench host``: rates of host and golden renderer, beside other renderers."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from splatline.cli.bench.options import folder_option
from splatline.cli.bench.sizes import LARGE, MEDIUM
from splatline.cli.options.outputs import check_folder, write_json, write_text
from splatline.cli.options.parameters import PRESET, SIZE
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Counter
from splatline.cli.report.statistics import tool_versions
from splatline.contract.presets import DEFAULT

if TYPE_CHECKING:
    from splatline.contract.config import EngineConfig
    from splatline.host.visibility.view import View

    from .race import Subject

__all__ = ["host"]

VIEWS: dict[str, tuple[float, tuple[str, ...]]] = {
    "whole": (1.0, ()),
    "whole, what is hidden skipped": (1.0, ("hidden",)),
    "from ten times as far": (0.1, ()),
    "a corner, 8 times as near": (8.0, ()),
    "a corner, 30 times as near": (30.0, ()),
}
"""Views of the large cloud: magnification, and skips in addition to the default ones."""


@click.command()
@click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD ...]")
@click.option("--size", type=SIZE, metavar="WxH", default="512x512", help="Size of the image.")
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine to draw for.")
@click.option(
    "--points",
    type=click.IntRange(1),
    default=LARGE,
    help="Points of the large cloud, which is resampled from the last cloud named, or the knot.",
)
@click.option("--repeats", type=click.IntRange(1), default=10, help="Frames; the fastest counts.")
@click.option("--peers/--no-peers", default=True, help="Measure other renderers too.")
@click.option(
    "--first-picture/--no-first-picture",
    default=True,
    help="Measure the time from a command to its picture too.",
)
@folder_option("host.json and host.md")
def host(
    clouds: tuple[Path, ...],
    size: tuple[int, int],
    preset: EngineConfig,
    points: int,
    repeats: int,
    peers: bool,
    first_picture: bool,
    out_dir: Path,
) -> None:
    """Measure the rates of the host's stages, and of other renderers in the same run.

    Draws the built-in scenes, the clouds named, and a large cloud in several views. The other
    renderers are measured if they are installed: pip install '.[peers]' and apt-get install
    libembree-dev. The time to the first picture is that of fresh processes, reading included.

    \b
    Examples:
      splatline bench host
      splatline bench host scan.ply --points 10000000
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    check_folder(out_dir)
    tell_compiling()
    from . import first_picture as firsts
    from .distances import DISTANCES, measure_distances
    from .page import page
    from .peers import PEERS
    from .race import race

    subjects = _subjects(clouds, size)
    cloud, _, radii = subjects[-1]
    kinds = firsts.kinds(points) if first_picture else ()
    steps = 2 * len(subjects) + 2 * len(VIEWS) + len(DISTANCES) + len(kinds)
    steps += 3 * len(PEERS) + len(kinds) * len(firsts.PEERS) if peers else 0
    with Counter(steps) as counter:
        far = _resampled(subjects[-1], points)
        runs = _wholes(subjects, preset, repeats, counter.advance)
        runs += _views(far, preset, repeats, counter.advance)
        distances = measure_distances(far, preset, repeats, counter.advance)
        rivals: list[dict[str, Any]] = []
        if peers:
            racing = subjects[-1], _resampled(subjects[-1], min(MEDIUM, points)), far
            rivals = race(racing, preset, counter.advance)
        options = ("--preset", preset.name)
        first = firsts.first_pictures(cloud, radii, kinds, options, size, peers, counter.advance)
    report = {
        "size": list(size),
        "preset": preset.name,
        "cores": len(os.sched_getaffinity(0)),
        "versions": tool_versions("golden"),
        "runs": runs,
        "distances": distances,
        "peers": rivals,
        "first_pictures": first,
    }
    text = page(report)
    out_dir.mkdir(parents=True, exist_ok=True)
    write_json(out_dir / "host.json", report)
    write_text(out_dir / "host.md", text)
    click.echo(text)


def _subjects(clouds: tuple[Path, ...], size: tuple[int, int]) -> list[Subject]:
    """Return cloud, view and radii of each scene and cloud file."""
    from splatline import host as library

    from .race import Subject

    found = []
    for name in ("terrain", "knot"):
        scene = library.load_scene(name)
        view = library.fit_view(
            scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, zoom=scene.zoom, size=size
        )
        found.append(Subject(scene.cloud, view, library.splat_radii(scene.cloud)))
    for path in clouds:
        cloud = library.read_cloud(path)
        view = library.fit_view(cloud, size=size)
        found.append(Subject(cloud, view, library.splat_radii(cloud)))
    return found


def _resampled(subject: Subject, points: int) -> Subject:
    """Return more points of a cloud, with the discs that ``splatline render`` draws of them."""
    from splatline.host.cloud.resample import resample
    from splatline.host.cloud.spacing import measure_discs

    from .race import Subject

    cloud, _ = resample(subject.cloud, subject.radii, points)
    return Subject(cloud, subject.view, measure_discs(cloud).radii)


def _wholes(
    subjects: list[Subject], preset: EngineConfig, repeats: int, announce: Callable[[str], None]
) -> list[dict[str, Any]]:
    """Return the times of each cloud as a whole, by quality."""
    from .frames import build, draw_frames

    runs = []
    for cloud, view, radii in subjects:
        index, facts = build(cloud, radii)
        for quality in ("fast", "exact"):
            announce(f"{cloud.name}, {quality}")
            run = draw_frames(index, view, quality, (), preset, repeats)
            runs.append({"cloud": cloud.name, "view": "whole", **facts, **run})
    return runs


def _views(
    subject: Subject, preset: EngineConfig, repeats: int, announce: Callable[[str], None]
) -> list[dict[str, Any]]:
    """Return the times of a cloud in each of ``VIEWS``, by quality."""
    from .frames import build, draw_frames

    cloud, view, radii = subject
    index, facts = build(cloud, radii)
    runs = []
    for name, (zoom, skips) in VIEWS.items():
        near = _nearer(view, zoom)
        for quality in ("fast", "exact"):
            announce(f"{cloud.name}, {name}")
            run = draw_frames(index, near, quality, skips, preset, max(3, repeats // 2))
            runs.append({"cloud": cloud.name, "view": name, **facts, **run})
    return runs


def _nearer(view: View, zoom: float) -> View:
    """Return a view with its focal length multiplied by a factor."""
    import dataclasses

    return dataclasses.replace(view, focal=view.focal * zoom)
