"""``splatline view``: a live view in the browser."""

from __future__ import annotations

import importlib.util

import click

from splatline.cli.options.cloud_and_view import live_options
from splatline.cli.options.drawing import background_option
from splatline.cli.options.large import is_large
from splatline.cli.options.request import RenderRequest
from splatline.cli.report.compiling import tell_compiling
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import PRESETS
from splatline.host.sample_positions import SAMPLES

__all__ = ["view"]


@click.command()
@live_options
@click.option(
    "--samples",
    type=click.Choice([str(number) for number in SAMPLES]),
    default="1",
    help="Samples a pixel of a picture at rest.",
)
@background_option
@click.option("--host", default="127.0.0.1", metavar="ADDRESS", help="Address that is served.")
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port; 0 is a free one.")
@click.option("--browser/--no-browser", default=True, help="Open the browser.")
def view(
    request: RenderRequest,
    samples: str,
    background: tuple[float, float, float] | None,
    host: str,
    port: int,
    browser: bool,
) -> None:
    """Look at a cloud in the browser: turn it, and see what each engine would draw, and how fast.

    Serves a page on this machine and opens it. Its pictures are bit for bit those of the engine.
    They are coarser while they move if the machine is slow, and have all samples at rest. The
    address has a token; who has it can see the cloud, and nothing else. Ctrl-C ends the server.

    \b
    Examples:
      splatline view                                       the built-in terrain
      splatline view scan.laz
      splatline view scan.laz --colour intensity --map magma
      splatline view scan.ply --up z --preset plane --samples 4
      splatline view part.stl --sample 1000000             points on the faces of a mesh
      splatline view scan.ply --target 3.5,-2,0 --distance 8
      splatline view scan.ply --port 8000 --no-browser     print the address alone
      splatline view scan.ply --host 0.0.0.0               for other machines of a trusted network
    """  # noqa: D301
    if importlib.util.find_spec("aiohttp") is None:
        raise InputError(f"view needs aiohttp: {install_hint('view')}")
    _check(request)
    tell_compiling()
    from splatline.cli.options.live import draw_settings, subject_of
    from splatline.view.choices import Choices
    from splatline.view.server.run import serve

    serve(
        subject_of(request),
        Choices(draw_settings(request, int(samples), background), request.colour),
        host=host,
        port=port,
        browser=browser,
        announce=lambda address: click.echo(f"{address}\nCtrl-C ends it."),
    )


def _check(request: RenderRequest) -> None:
    """Raise ``InputError`` if a request is none for a live view, or its file cannot be read."""
    if request.preset.name not in PRESETS:
        raise InputError(f"view draws the presets {', '.join(PRESETS)}")
    if request.path is None:
        return
    if str(request.path) == "-":
        raise InputError("view reads its file again for other colours: give a file, not -")
    if len(request.paths) > 1:
        raise InputError("view shows one cloud; `splatline render` draws many as one")
    from splatline.host.files.readers import open_cloud_file

    with open_cloud_file(request.path, format=request.format):
        pass
    if is_large(request):
        raise InputError(
            f"{request.path} needs more than a quarter of the memory: view holds a cloud in memory;"
            " `splatline render` draws it in parts"
        )
