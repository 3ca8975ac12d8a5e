"""``splatline film``: a cloud from a moving camera, as an MP4, a GIF or a WebP."""

from __future__ import annotations

from pathlib import Path

import click

from splatline.cli.options.cloud_and_view import film_options
from splatline.cli.options.drawing import background_option
from splatline.cli.options.large import is_large
from splatline.cli.options.outputs import check_files
from splatline.cli.options.request import RenderRequest
from splatline.cli.report.compiling import tell_compiling
from splatline.cli.report.progress import Stages
from splatline.contract.errors import InputError
from splatline.host.sample_positions import SAMPLES

__all__ = ["film"]


@click.command()
@film_options
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    required=True,
    help="The film: .mp4 (H.264; needs the extra film), .webp or .gif.",
)
@click.option(
    "--path",
    metavar="turntable|FILE",
    default="turntable",
    help="turntable: once round the cloud, from --orbit on. FILE: keyframes as JSON or CSV; see"
    " below.",
)
@click.option(
    "--seconds",
    type=float,
    metavar="S",
    show_default="8, or those of the path",
    help="Length of the film.",
)
@click.option("--fps", type=float, metavar="N", default=30.0, help="Frames a second.")
@click.option(
    "--fidelity",
    type=float,
    metavar="N",
    default=80.0,
    help="Of an MP4 or a WebP, 0 to 100: more is larger. A WebP of 100 has the engine's very"
    " pixels.",
)
@click.option(
    "--samples",
    type=click.Choice([str(number) for number in SAMPLES]),
    default="1",
    help="Samples a pixel.",
)
@background_option
def film(
    request: RenderRequest,
    output: Path,
    path: str,
    seconds: float | None,
    fps: float,
    fidelity: float,
    samples: str,
    background: tuple[float, float, float] | None,
) -> None:
    """Draw a film of a point cloud, or of a built-in scene if there is no CLOUD.

    Each frame is the picture that 'splatline render' draws with the same camera. A turntable, and
    a path whose last keyframe is its first, can be played again and again without a halt.

    \b
    A path in JSON; what a keyframe leaves out is as of the turntable:
      [{"time": 0, "azimuth": 30, "elevation": 20},
       {"time": 2, "azimuth": 120, "elevation": 60, "distance": 14.5},
       {"time": 5, "azimuth": 200, "target": [1.5, 0, -2]}]
    The same in CSV; x, y and z are the target:
      time,azimuth,elevation,distance,x,y,z
      0,30,20,,,,
      2,120,60,14.5,,,
      5,200,,,1.5,0,-2

    Times are seconds, angles degrees, lengths the cloud's unit. The camera passes through the
    keyframes on a Catmull-Rom spline, and azimuths go the short way round.

    \b
    Examples:
      splatline film -o terrain.mp4                        the terrain turns
      splatline film scan.ply -o scan.webp --samples 4 --size 640x480
      splatline film scan.laz -o scan.gif --seconds 4 --fps 20 --colour height
      splatline film scan.ply -o flight.mp4 --path flight.json
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    from splatline.view.film.film import TURNTABLE, check_film

    keys = None if path == TURNTABLE else Path(path)
    check_film(output, request.size, fps, fidelity, seconds)
    check_files((output,), inputs=(*request.paths, keys))
    if is_large(request):
        raise InputError(f"{request.path}: a film is drawn of one cloud that fits the memory")
    if keys is not None and not keys.is_file():
        raise InputError(f"{keys}: there is no such file; give turntable or a file of keyframes")

    from splatline.cli.options.live import draw_settings, prepare_live
    from splatline.view.film.film import make_film, plan_cameras
    from splatline.view.film.turntable import fit_turntable

    tell_compiling()
    stages = Stages()
    live, camera = prepare_live(request, stages)
    home = fit_turntable(live.cloud, live.discs.radii, size=request.size, **camera)
    cameras = plan_cameras(home, path, seconds, fps)
    settings = draw_settings(request, int(samples), background)
    with stages.stage("film", f"Drawing {len(cameras):,} frames") as share:
        made = make_film(
            live, cameras, output, size=request.size, fps=fps, fidelity=fidelity,
            settings=settings, progress=share,
        )  # fmt: skip
    click.echo(
        f"{made.path}: {made.frames:,} frames, {made.seconds:g} s, {made.bytes / 1e6:.2f} MB"
    )
