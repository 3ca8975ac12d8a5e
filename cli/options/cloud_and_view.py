"""Options of commands that draw: a cloud or a built-in scene, its view, and the encoding."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click
from click.core import ParameterSource

from splatline.contract.presets import DEFAULT
from splatline.host.encode.quality import DEFAULT_QUALITY, QUALITIES, SHAPE_SOURCES
from splatline.host.files.wanted import UNDRAWN
from splatline.host.shading.light_sets import DEFAULT_LIGHTS, LIGHTS
from splatline.host.visibility.skips import DEFAULT_SKIPS, SKIPS

from .colour_by import colour_by, colour_options
from .large import LARGE_OPTIONS
from .parameters import DISTANCE, ORBIT, PRESET, SIZE, SPLAT_SIZE, TARGET, UP_AXES
from .request import RenderRequest

__all__ = ["film_options", "live_options", "request_options"]

_Command = TypeVar("_Command", bound=Callable[..., Any])

DEFAULT_SCENE = "terrain"


_ENCODING_OPTIONS = (
    click.option(
        "--lights",
        type=click.Choice(list(LIGHTS)),
        default=DEFAULT_LIGHTS,
        help="Lights, which move with the camera. none: the points' own colours.",
    ),
    click.option(
        "--keep",
        type=click.Choice([*sorted(DEFAULT_SKIPS), *UNDRAWN]),
        multiple=True,
        help="Do not leave out these points (may be given several times). "
        + "; ".join(f"{name}: {what}" for name, what in UNDRAWN.items())
        + "; the others: see --skip.",
    ),
    click.option(
        "--skip",
        type=click.Choice(list(SKIPS)),
        multiple=True,
        show_default=", ".join(name for name in SKIPS if name in DEFAULT_SKIPS),
        help="Leave out these points too (may be given several times). "
        + "; ".join(f"{name}: {what}" for name, what in SKIPS.items())
        + ".",
    ),
    click.option(
        "--shapes",
        type=click.Choice(list(SHAPE_SOURCES)),
        default="table",
        help="; ".join(f"{name}: {what}" for name, what in SHAPE_SOURCES.items())
        + ". rom implies the quality paper, and the variant of --preset that has a ROM.",
    ),
    click.option(
        "--specks",
        type=click.Choice(["close", "keep"]),
        default="close",
        help="close: single pixels that show through a surface take the depth and colour of a"
        " neighbour, and small discs do not overlap; keep: the discs as they are, as with"
        " --shapes rom.",
    ),
    click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine to draw for."),
    click.option(
        "--quality",
        type=click.Choice(list(QUALITIES)),
        default=DEFAULT_QUALITY,
        help="; ".join(f"{name}: {what}" for name, what in QUALITIES.items()) + ".",
    ),
    click.option(
        "--splat-size",
        type=SPLAT_SIZE,
        metavar="auto|WORLD",
        default="auto",
        help="Diameter of the splats in the cloud's unit; auto: from the points' spacing.",
    ),
)
"""Options of the encoding, last one first."""

_VIEW_OPTIONS = (
    click.option(
        "--fit",
        type=click.Choice(["bulk", "all"]),
        default="bulk",
        help="bulk: points far from the rest are not drawn, and counted; all: the view fits every"
        " point.",
    ),
    click.option(
        "--distance",
        type=DISTANCE,
        metavar="D",
        help="With --target: from the eye to the target, in the cloud's unit.",
    ),
    click.option(
        "--target",
        type=TARGET,
        metavar="X,Y,Z",
        show_default="the view fits the cloud",
        help="Look at this point, in the coordinates of the file; needs --distance.",
    ),
    click.option(
        "--zoom",
        type=float,
        metavar="F",
        show_default="the scene's, or 1",
        help="Magnification about the middle of the picture; 1 fits the cloud.",
    ),
    click.option(
        "--up",
        type=UP_AXES,
        show_default="the scene's; z for LAS, LAZ, E57 and PTX; or y",
        help="Axis that points up.",
    ),
    click.option(
        "--fov",
        type=float,
        metavar="DEG",
        show_default="the scene's, or 35",
        help="Field of view over the shorter side.",
    ),
    click.option(
        "--orbit",
        type=ORBIT,
        metavar="AZ,EL",
        show_default="the scene's, or 30,20",
        help="Azimuth and elevation of the eye in degrees.",
    ),
    click.option(
        "--size",
        type=SIZE,
        metavar="WxH",
        default="512x512",
        help="Size of the image in pixels.",
    ),
    click.option(
        "--scene",
        metavar="NAME",
        show_default=DEFAULT_SCENE,
        help="Built-in scene, drawn if there is no CLOUD: terrain or knot.",
    ),
    click.option(
        "--sample",
        type=click.IntRange(min=1),
        metavar="N",
        help="Spread N points over the faces of a mesh; without it its vertices are drawn.",
    ),
    click.option(
        "--format",
        metavar="NAME",
        show_default="by the name of CLOUD",
        help="Format of CLOUD: ply pcd las laz e57 obj stl off glb npz npy xyz xyzn xyzrgb pts ptx"
        " txt asc or csv; also compressed by gzip. '-' as CLOUD is the standard input.",
    ),
    click.argument("clouds", nargs=-1, type=click.Path(path_type=Path), metavar="[CLOUD]..."),
)
"""The argument CLOUD and the options of the view, last one first."""

_OF_VIEW = {"zoom", "size"}
"""Options that a live view has no use for: it has a size and a distance of its own."""

_OF_WORDS = {"shapes"}
"""Options that change the code words alone, not the picture."""

_OF_TARGET = {"target", "distance"}


def request_options(command: _Command) -> _Command:
    """Add CLOUD and the options of view and encoding; the command gets one ``request``."""
    return _with_options(command, (*_ENCODING_OPTIONS, *LARGE_OPTIONS, *_VIEW_OPTIONS))


def live_options(command: _Command) -> _Command:
    """Add what a live view takes of these options; the command gets one ``request``."""
    return _with_options(command, _options_without(_OF_VIEW | _OF_WORDS))


def film_options(command: _Command) -> _Command:
    """Add what a film takes of these options; the command gets one ``request``."""
    return _with_options(command, _options_without(_OF_TARGET | _OF_WORDS))


def _options_without(names: set[str]) -> list[Callable[[Any], Any]]:
    """Return the options of encoding and view, without some."""
    every = (*_ENCODING_OPTIONS, *_VIEW_OPTIONS)
    return [option for option in every if not names & _names_of(option)]


def _names_of(option: Callable[[_Command], _Command]) -> set[str]:
    """Return the names that an option has."""

    def nothing() -> None:
        """Take the option."""

    return {parameter.name or "" for parameter in option(nothing).__click_params__}


def _with_options(command: _Command, own: Sequence[Callable[[_Command], _Command]]) -> _Command:
    """Add options; the command gets a ``request`` of their values."""

    @functools.wraps(command)
    def with_request(clouds: tuple[Path, ...], scene: str | None, **options: Any) -> Any:
        skip, keep = set(options.pop("skip")), set(options.pop("keep"))
        by_colour = [options.pop(name) for name in ("colour", "colour_map", "colour_range")]
        if clouds and scene is not None:
            raise click.UsageError("give a CLOUD or a --scene, not both")
        of_files = [name for name in ("format", "sample", "memory", "dask") if options.get(name)]
        if of_files and not clouds:
            raise click.UsageError(f"--{of_files[0]} needs a CLOUD")
        if (options.get("target") is None) != (options.get("distance") is None):
            raise click.UsageError("--target and --distance go together: give both or neither")
        if both := skip & keep:
            raise click.UsageError(f"--skip and --keep name the same: {', '.join(sorted(both))}")
        if options.get("shapes") == "rom":
            options["quality"] = _quality_for_rom(options["quality"])
            options["preset"] = options["preset"].with_shapes()
        options["close_specks"] = options.pop("specks") == "close"
        if options.get("shapes") == "rom":
            options["close_specks"] = False
        names = {field.name for field in dataclasses.fields(RenderRequest)} & set(options)
        request = RenderRequest(
            clouds,
            scene or DEFAULT_SCENE,
            skips=(DEFAULT_SKIPS | skip) - keep,
            keep=frozenset(keep & UNDRAWN.keys()),
            colour=colour_by(*by_colour),
            **{name: options.pop(name) for name in names},
        )
        return command(request=request, **options)

    decorated: Any = with_request
    for option in own:
        decorated = option(decorated)
    return colour_options(decorated)


def _quality_for_rom(quality: str) -> str:
    """Return the quality that a shape ROM needs; raise if another one was asked for."""
    context = click.get_current_context()
    if quality != "paper" and context.get_parameter_source("quality") != ParameterSource.DEFAULT:
        raise click.UsageError(f"--shapes rom needs --quality paper, not {quality}")
    return "paper"
