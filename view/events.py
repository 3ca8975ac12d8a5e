"""Events of a live view and their answers: plain values, no network."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from splatline.contract.errors import InputError
from splatline.contract.presets import PRESETS
from splatline.host.encode.quality import QUALITIES
from splatline.host.files.wanted import ColourBy
from splatline.host.sample_positions import SAMPLES
from splatline.host.shading.light_sets import LIGHTS

from .hex_colour import read_hex

__all__ = ["DEFAULT_COLOUR", "LARGEST", "PICTURES", "SMALLEST", "Event", "check_event"]

SMALLEST, LARGEST = 16, 4096
"""Sides of a picture in pixels."""

FARTHEST = 1e5
"""Most pixels of a step, and from the corner of a picture."""

PICTURES = ("paper", "engine", "reference")
"""Sides of a split: the paper's engine, the chosen one, and the exact reference."""

DEFAULT_COLOUR = "default"
"""Stands for the file's own colours, else its intensity, else one colour."""


@dataclass(frozen=True)
class Event:
    """Something that a person did.

    Parameters
    ----------
    kind
        ``resize``, ``turn``, ``pan``, ``zoom``, ``look``, ``reset``, ``orbit``, ``camera``,
        ``moving``, ``set``, ``shown``, ``save`` or ``command``.
    values
        Its values by name, all checked.
    """

    kind: str
    values: dict[str, Any]


@dataclass(frozen=True)
class _Number:
    """A finite number between two others; ``whole`` if it is an integer."""

    least: float
    most: float
    whole: bool = False

    def __call__(self, name: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{name} must be a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not self.least <= number <= self.most:  # false for NaN
            raise InputError(f"{name} must lie in {self.least:g} to {self.most:g}")
        if not self.whole:
            return number
        if number != int(number):
            raise InputError(f"{name} must be a whole number")
        return int(number)


@dataclass(frozen=True)
class _OneOf:
    """One of some words."""

    words: tuple[str, ...]

    def __call__(self, name: str, value: object) -> str:
        if not isinstance(value, str) or value not in self.words:
            raise InputError(f"{name} must be one of {', '.join(self.words)}")
        return value


def _truth(name: str, value: object) -> bool:
    """Return a truth value."""
    if not isinstance(value, bool):
        raise InputError(f"{name} must be true or false")
    return value


def _samples(name: str, value: object) -> int:
    """Return a number of samples a pixel."""
    if isinstance(value, bool) or not isinstance(value, int) or value not in SAMPLES:
        raise InputError(f"{name} must be one of {', '.join(map(str, SAMPLES))}")
    return value


def _background(name: str, value: object) -> tuple[float, float, float]:
    """Return red, green and blue in 0..1 of ``#rrggbb``."""
    read = read_hex(value) if isinstance(value, str) else None
    if read is None:
        raise InputError(f"{name} must be a colour such as #171a1f")
    return read


def _colour(name: str, value: object) -> ColourBy | None:
    """Return what colours a point; None: the file's own colours."""
    if not isinstance(value, dict):
        raise InputError(f"{name} must be an object with by, map and range")
    by, table, ends = (value.get(key) for key in ("by", "map", "range"))
    if not isinstance(by, str) or not by or len(by) > 200:
        raise InputError(f"{name} must name a field")
    if table is not None and (not isinstance(table, str) or len(table) > 100):
        raise InputError(f"the map of {name} must be a name or null")
    if ends is not None:
        if not isinstance(ends, list) or len(ends) != 2:
            raise InputError(f"the range of {name} must be two numbers or null")
        number = _Number(-1e300, 1e300)
        ends = number("range", ends[0]), number("range", ends[1])
    if by == DEFAULT_COLOUR:
        return None
    return ColourBy(by, table, ends)


def _target(name: str, value: object) -> tuple[float, float, float]:
    """Return a point of the cloud's space."""
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{name} must be three numbers")
    number = _Number(-1e300, 1e300)
    x, y, z = (number(name, coordinate) for coordinate in value)
    return x, y, z


def _split(name: str, value: object) -> tuple[str, str] | None:
    """Return the pictures at the left and the right of a split; None: one picture."""
    if value is None:
        return None
    if not isinstance(value, dict):
        raise InputError(f"{name} must be null or an object with left and right")
    one = _OneOf(PICTURES)
    return one("left", value.get("left")), one("right", value.get("right"))


_Check = Callable[[str, object], Any]

_PIXELS = _Number(-FARTHEST, FARTHEST)
_SIDE = _Number(SMALLEST, LARGEST, whole=True)

_ORBIT: dict[str, _Check] = {
    "azimuth": _Number(-720.0, 720.0),
    "elevation": _Number(-90.0, 90.0),
}

_KINDS: dict[str, dict[str, _Check]] = {
    "resize": {"width": _SIDE, "height": _SIDE},
    "turn": {"dx": _PIXELS, "dy": _PIXELS},
    "pan": {"dx": _PIXELS, "dy": _PIXELS},
    "zoom": {"factor": _Number(0.1, 10.0), "x": _PIXELS, "y": _PIXELS},
    "look": {"x": _PIXELS, "y": _PIXELS},
    "reset": {},
    "orbit": _ORBIT,
    "camera": {"target": _target, "distance": _Number(1e-300, 1e300), **_ORBIT},
    "moving": {"value": _truth},
    "shown": {"frame": _Number(0, 2**53, whole=True)},
    "save": {"what": _OneOf(("png", "words"))},
    "command": {},
}
"""Values of each kind of event but ``set``, and how each is checked."""

_SETTINGS: dict[str, _Check] = {
    "preset": _OneOf(tuple(PRESETS)),
    "quality": _OneOf(tuple(QUALITIES)),
    "samples": _samples,
    "lights": _OneOf(tuple(LIGHTS)),
    "background": _background,
    "colour": _colour,
    "show": _OneOf(("picture", "depth")),
    "split": _split,
}
"""Settings, and how a value of each is checked."""


def check_event(message: object) -> Event:
    """Return the event that a message tells; values that it does not have are ignored.

    Parameters
    ----------
    message
        What JSON of the protocol holds; see :mod:`splatline.view.server.protocol`.

    Raises
    ------
    InputError
        If it tells no event, or a value is missing or out of its range; one line.
    """
    if not isinstance(message, dict):
        raise InputError("a message must be a JSON object")
    kind = message.get("type")
    if kind == "set":
        name = _OneOf(tuple(_SETTINGS))("the name of a setting", message.get("name"))
        return Event("set", {"name": name, "value": _SETTINGS[name](name, message.get("value"))})
    if not isinstance(kind, str) or kind not in _KINDS:
        raise InputError(f"no message of the type {str(kind)[:40]!r}")
    return Event(kind, {name: of(name, message.get(name)) for name, of in _KINDS[kind].items()})
