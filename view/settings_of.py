"""Settings of a drawing from plain names, as a person writes them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.presets import DEFAULT, REMOVED
from splatline.contract.variants import CONFIGS
from splatline.host.encode.quality import DEFAULT_QUALITY
from splatline.host.pipeline import check_request
from splatline.host.shading.light_sets import DEFAULT_LIGHTS, LIGHTS
from splatline.host.visibility.skips import DEFAULT_SKIPS, check_skips
from splatline.plots.figure import BACKGROUND

from .draw import Settings
from .hex_colour import read_hex

__all__ = ["settings_of"]


def settings_of(
    *,
    preset: str | EngineConfig = DEFAULT,
    quality: str = DEFAULT_QUALITY,
    samples: int = 1,
    skips: Iterable[str] = DEFAULT_SKIPS,
    close_specks: bool = True,
    lights: str = DEFAULT_LIGHTS,
    background: str | Sequence[float] | None = None,
) -> Settings:
    """Return settings.

    Parameters
    ----------
    preset
        The engine, or its name, such as ``paper``.
    quality, samples, skips, close_specks
        As of ``make_frames``.
    lights
        One of ``LIGHTS``.
    background
        ``#rrggbb``, or red, green and blue in 0..1; None: dark grey.

    Raises
    ------
    InputError
        If an option has no such value, or does not go with another.
    """
    if lights not in LIGHTS:
        raise InputError(f"no lights named {lights!r}; there are: {', '.join(LIGHTS)}")
    config, chosen = _config(preset), check_skips(skips)
    check_request(samples, config, quality, "table", chosen)
    return Settings(config, quality, samples, chosen, lights, _background(background), close_specks)


def _config(preset: str | EngineConfig) -> EngineConfig:
    """Return an engine's configuration."""
    if isinstance(preset, EngineConfig):
        return preset
    if preset in REMOVED:
        raise InputError(f"preset {preset!r} was removed; take {REMOVED[preset]}")
    if preset not in CONFIGS:
        raise InputError(f"no preset named {preset!r}; there are: {', '.join(CONFIGS)}")
    return CONFIGS[preset]


def _background(colour: str | Sequence[float] | None) -> tuple[float, float, float]:
    """Return red, green and blue in 0..1."""
    if colour is None:
        return BACKGROUND
    if isinstance(colour, str):
        read = read_hex(colour)
        if read is None:
            raise InputError(f"{colour!r} is not a colour; write #rrggbb")
        return read
    levels = [float(level) for level in colour]
    if len(levels) != 3 or not all(0.0 <= level <= 1.0 for level in levels):
        raise InputError(f"the background must be red, green and blue in 0..1, not {colour!r}")
    return levels[0], levels[1], levels[2]
