"""Parameter types of the command line: sizes, angles, colours and presets."""

from __future__ import annotations

import math
import re
from typing import Any

import click

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PRESETS, REMOVED
from splatline.contract.variants import CONFIGS

__all__ = [
    "COLOUR",
    "DIAMETER",
    "DISTANCE",
    "MEMORY",
    "ORBIT",
    "PRESET",
    "RANGE",
    "SIZE",
    "SPLAT_SIZE",
    "TARGET",
    "UP_AXES",
]

UP_AXES = click.Choice(["x", "y", "z", "-x", "-y", "-z"])
"""The axes that ``host.visibility.view.fit_view`` accepts."""

_NAMED_COLOURS = {"white": "ffffff", "black": "000000", "grey": "808080", "gray": "808080"}


# Parameter types and choices are generic in the newest click but not in 8.1, hence the ignores.


class _Size(click.ParamType):  # type: ignore[type-arg]
    """``WxH``: width and height in pixels."""

    name = "WxH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Return (width, height)."""
        if isinstance(value, tuple):
            return value
        match = re.fullmatch(r"\s*(\d{1,6})\s*[xX]\s*(\d{1,6})\s*", value, re.ASCII)
        if match is None:
            self.fail(f"{value!r} is not a size; write WIDTHxHEIGHT, like 512x512", param, ctx)
        width, height = int(match[1]), int(match[2])
        if not (width and height):
            self.fail(f"{value!r} has no pixel; both sides must be at least 1", param, ctx)
        return width, height


class _Orbit(click.ParamType):  # type: ignore[type-arg]
    """``AZ,EL``: azimuth and elevation of the eye in degrees."""

    name = "AZ,EL"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Return (azimuth, elevation)."""
        if isinstance(value, tuple):
            return value
        angles = [angle for part in value.split(",") if (angle := _finite(part)) is not None]
        if len(angles) != 2 or value.count(",") != 1:
            self.fail(
                f"{value!r} is not an orbit; write AZIMUTH,ELEVATION in degrees, like 30,20",
                param,
                ctx,
            )
        return angles[0], angles[1]


class _Range(click.ParamType):  # type: ignore[type-arg]
    """``LOW,HIGH``: two numbers, the lower first."""

    name = "LOW,HIGH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Return (low, high)."""
        if isinstance(value, tuple):
            return value
        ends = [end for part in value.split(",") if (end := _finite(part)) is not None]
        if len(ends) != 2 or value.count(",") != 1 or not ends[0] < ends[1]:
            self.fail(
                f"{value!r} is not a range; write LOW,HIGH, the lower number first, like 0,255",
                param,
                ctx,
            )
        return ends[0], ends[1]


class _Target(click.ParamType):  # type: ignore[type-arg]
    """``X,Y,Z``: three coordinates."""

    name = "X,Y,Z"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float, float]:
        """Return (x, y, z)."""
        if isinstance(value, tuple):
            return value
        numbers = [number for part in value.split(",") if (number := _finite(part)) is not None]
        if len(numbers) != 3 or value.count(",") != 2:
            self.fail(f"{value!r} is no point; write X,Y,Z, like 3.5,-2,0", param, ctx)
        return numbers[0], numbers[1], numbers[2]


class _Distance(click.ParamType):  # type: ignore[type-arg]
    """A finite length above 0."""

    name = "D"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the length."""
        length = value if isinstance(value, float) else _finite(value)
        if length is None or length <= 0.0:
            self.fail(f"{value!r} is no distance; write a number above 0", param, ctx)
        return length


class _SplatSize(click.ParamType):  # type: ignore[type-arg]
    """``auto``, or the diameter of splats."""

    def __init__(self, name: str, unit: str) -> None:
        self.name = name
        self._unit = unit

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | None:
        """Return the diameter, or None for the cloud's own spacing."""
        if value is None or value == "auto":
            return None
        size = value if isinstance(value, float) else _finite(value)
        if size is None or size <= 0.0:
            self.fail(
                f"{value!r} is not a splat size; write auto, or a diameter above 0 in {self._unit}",
                param,
                ctx,
            )
        return size


class _Colour(click.ParamType):  # type: ignore[type-arg]
    """``#RRGGBB``, white, black or grey."""

    name = "#RRGGBB"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float, float]:
        """Return red, green and blue in 0..1."""
        if isinstance(value, tuple):
            return value
        digits = _NAMED_COLOURS.get(value.lower(), value.removeprefix("#"))
        if re.fullmatch(r"[0-9a-fA-F]{6}", digits) is None:
            self.fail(f"{value!r} is not a colour; write #RRGGBB, white, black or grey", param, ctx)
        red, green, blue = (byte / 255.0 for byte in bytes.fromhex(digits))
        return red, green, blue


class _Memory(click.ParamType):  # type: ignore[type-arg]
    """A number of bytes, such as ``2G``."""

    name = "SIZE"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return bytes."""
        if isinstance(value, int):
            return value
        match = re.fullmatch(r"\s*(\d{1,9}(?:\.\d{1,9})?)\s*([MGT])(?:i?B)?\s*", value, re.I)
        if match is None or not float(match[1]):
            self.fail(f"{value!r} is no size of memory; write one like 500M or 2G", param, ctx)
        return int(float(match[1]) * 1024 ** (2 + "MGT".index(match[2].upper())))


class _Preset(click.Choice):  # type: ignore[type-arg]
    """Name of an engine's configuration: a preset or a variant."""

    def __init__(self) -> None:
        super().__init__([*sorted(PRESETS), *(name for name in CONFIGS if name not in PRESETS)])

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> EngineConfig:
        """Return the configuration."""
        if isinstance(value, EngineConfig):
            return value
        if value in REMOVED:
            self.fail(f"preset {value!r} was removed; take {REMOVED[value]}", param, ctx)
        return CONFIGS[super().convert(value, param, ctx)]


def _finite(text: str) -> float | None:
    """Return a finite number, or None if the text is not one."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


SIZE = _Size()
ORBIT = _Orbit()
TARGET = _Target()
DISTANCE = _Distance()
RANGE = _Range()
SPLAT_SIZE = _SplatSize("auto|WORLD", "the cloud's own unit")
DIAMETER = _SplatSize("auto|PIXELS", "pixels")
COLOUR = _Colour()
MEMORY = _Memory()
PRESET = _Preset()
