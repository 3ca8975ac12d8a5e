"""``splatline view``: a live view in the browser."""

from __future__ import annotations

import importlib.util

import click

from splatline.cli.options.cloud_and_view import live_options
from splatline.cli.options.drawing import background_option
from splatline.cli.options.request import RenderRequest
from splatline.contract.errors import InputError, install_hint
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
    """Look at a cloud in the browser, as the engine draws it.

    \b
    Examples:
      splatline view                         the built-in terrain
      splatline view scan.laz
    """  # noqa: D301
    if importlib.util.find_spec("aiohttp") is None:
        raise InputError(f"view needs aiohttp: {install_hint('view')}")
    from splatline.cli.options.prepare import subject_of
    from splatline.view.choices import Choices
    from splatline.view.draw import Settings
    from splatline.view.server.run import serve

    settings = Settings(
        preset=request.preset,
        quality=request.quality,
        samples=int(samples),
        skips=request.skips,
        lights=request.lights,
        **({} if background is None else {"background": background}),
    )
    serve(
        subject_of(request),
        Choices(settings, request.colour),
        host=host,
        port=port,
        browser=browser,
        announce=lambda address: click.echo(f"{address}\nCtrl-C ends it."),
    )
