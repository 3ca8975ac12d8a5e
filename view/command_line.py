"""The command line that makes the very picture that a live view shows."""

from __future__ import annotations

import shlex

from splatline.contract.presets import DEFAULT
from splatline.host.encode.quality import DEFAULT_QUALITY
from splatline.host.files.wanted import ColourBy
from splatline.host.shading.light_sets import DEFAULT_LIGHTS
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.plots.figure import BACKGROUND

from .camera import Camera
from .draw import Settings
from .hex_colour import hex_colour
from .subject import Subject

__all__ = ["render_command", "shell_text"]


def render_command(
    subject: Subject,
    colour: ColourBy | None,
    camera: Camera,
    size: tuple[int, int],
    settings: Settings,
) -> list[str]:
    """Return the arguments of ``splatline`` that draw a picture, bit for bit.

    Parameters
    ----------
    subject, colour
        The cloud and its colours.
    camera
        Where it is seen from; rounded, lest the line be long.
    size
        Width and height in pixels.
    settings
        How it is drawn.
    """
    words = ["render"]
    words += ["--scene", subject.scene] if subject.path is None else [str(subject.path)]
    options = {
        "--format": subject.format,
        "--sample": subject.sample,
        "--fit": None if subject.fit == "bulk" else subject.fit,
        "--splat-size": None if subject.splat_size is None else repr(subject.splat_size),
        "--target": ",".join(map(_digits, camera.target)),
        "--distance": _digits(camera.distance),
        "--orbit": ",".join(map(_digits, camera.orbit)),
        "--fov": _digits(camera.fov),
        "--up": camera.up,
        "--size": f"{size[0]}x{size[1]}",
        **_colour_options(colour),
        **_settings_options(settings),
        "--output": f"{subject.name}.png",
    }
    for name, value in options.items():
        if value is not None:
            words += [name, str(value)]
    for reason in sorted(settings.skips - DEFAULT_SKIPS):
        words += ["--skip", reason]
    for reason in sorted((DEFAULT_SKIPS - settings.skips) | subject.keep):
        words += ["--keep", reason]
    return words


def shell_text(words: list[str]) -> str:
    """Return arguments of ``splatline`` as a line for a shell."""
    return shlex.join(["splatline", *words])


def _colour_options(colour: ColourBy | None) -> dict[str, str | None]:
    """Return the options for what colours a point."""
    if colour is None:
        return {}
    ends = None if colour.range is None else ",".join(map(_digits, colour.range))
    return {"--colour": colour.field, "--map": colour.map, "--range": ends}


def _settings_options(settings: Settings) -> dict[str, object]:
    """Return the options of the encoding that are not as by default."""
    values: dict[str, tuple[object, object]] = {
        "--preset": (settings.preset.name, DEFAULT.name),
        "--quality": (settings.quality, DEFAULT_QUALITY),
        "--samples": (settings.samples, 1),
        "--specks": ("close" if settings.close_specks else "keep", "close"),
        "--lights": (settings.lights, DEFAULT_LIGHTS),
        "--background": (hex_colour(settings.background), hex_colour(BACKGROUND)),
    }
    return {name: value for name, (value, usual) in values.items() if value != usual}


def _digits(value: float) -> str:
    """Return the shortest text of a number that is read as the same number."""
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))
