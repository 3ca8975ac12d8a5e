"""A reader's request besides positions and normals: the source of colours, and ranges."""

from __future__ import annotations

import math
from dataclasses import dataclass

from splatline.contract.errors import InputError

__all__ = [
    "CLASSIFICATION",
    "EMPTY",
    "HEIGHT",
    "INTENSITY",
    "NOISE",
    "RGB",
    "UNDRAWN",
    "USUAL",
    "WITHHELD",
    "ColourBy",
    "Wanted",
]

RGB, HEIGHT, INTENSITY, CLASSIFICATION = "rgb", "height", "intensity", "classification"
"""Fields that need not have these names in a file; any other field is a column's name."""

WITHHELD, NOISE, EMPTY = "withheld", "noise", "empty"

UNDRAWN = {
    WITHHELD: "points of LAS that are flagged as withheld",
    NOISE: "points of LAS that are classified as noise",
    EMPTY: "points at exactly 0, 0, 0 if there are several, as of returns that found nothing",
}
"""Points of files that are not drawn unless they are asked for, by name."""


@dataclass(frozen=True)
class ColourBy:
    """What colours a point.

    Parameters
    ----------
    field
        ``rgb``: the file's own colours. ``height``: the coordinate along ``up``. ``intensity``.
        ``classification``: a colour for each class, those of the ASPRS standard in their usual
        ones. Else the name of a column of numbers.
    map
        Name of one of matplotlib's colour maps. None: greys for the intensity, else ``viridis``.
    range
        Values at both ends of the map. None: from the values; see ``colouring``.
    up
        Axis of the height: x, y or z, with a minus for the other direction.

    Raises
    ------
    InputError
        If a map or a range is given that ``field`` has no use for, or the range is none.
    """

    field: str
    map: str | None = None
    range: tuple[float, float] | None = None
    up: str = "y"

    def __post_init__(self) -> None:
        if self.kind in (RGB, CLASSIFICATION):
            for name, value in (("map", self.map), ("range", self.range)):
                if value is not None:
                    raise InputError(f"colours by {self.kind} need no {name}; leave it out")
        if self.range is not None:
            low, high = self.range
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise InputError(
                    f"the range of colours {low:g},{high:g} must be two numbers, the lower first;"
                    " a map whose name ends in _r is reversed"
                )

    @property
    def kind(self) -> str:
        """The field in lower case, without blanks about it."""
        return self.field.strip().lower()


@dataclass(frozen=True)
class Wanted:
    """A request to a reader.

    Parameters
    ----------
    colour
        What colours a point. None: the file's colours, else its intensity.
    ranges
        Whether the least and the greatest value of every column are wanted.
    sample
        Points on the faces of a mesh; None: its vertices.
    keep
        Which of ``UNDRAWN`` are drawn.
    """

    colour: ColourBy | None = None
    ranges: bool = False
    sample: int | None = None
    keep: frozenset[str] = frozenset()


USUAL = Wanted()
"""The file's own colours, and no ranges."""
