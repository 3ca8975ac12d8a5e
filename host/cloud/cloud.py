"""A point cloud in memory."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from .cells import Cells, build_cells
from .closing import Closing
from .curve_order import Curve, sort_along_curve

__all__ = ["Cloud"]

CACHED = ("curve", "cells")
"""Values that depend on the positions alone."""


@dataclass(frozen=True)
class Cloud:
    """Oriented, coloured points: every array has one row a point.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, in the file's own unit, relative to ``origin``.
    normals
        Shape (n, 3), float32, of unit length, pointing out of the surface.
    colours
        Shape (n, 3), uint8: red, green, blue.
    two_sided
        Shape (n,), bool: the normal was estimated, or is a splat's axis. Its sign means nothing,
        and is chosen so that it faces the viewer. Such a point never faces away. ``turn_upward``
        gives a sign to some of them.
    origin
        Shape (3,), float64: the cloud's own centre. Positions are relative to it, so a scan in map
        coordinates (10^7) is drawn as exactly as one at zero.
    name
        Its name in reports.
    dropped
        Points left out when the cloud was read, by reason.
    used
        What each column of the file was taken for, by its name.
    ignored
        Columns of the file that are not used.
    notes
        What a person should know about how the file was read; each is one line.
    colour_key
        What the colours stand for if values became colours, ready for JSON: ``by``, the field;
        ``map`` and ``range``, or ``classes``; ``without_value``, the number of points without a
        value. Empty if the colours are the file's own.
    facts
        What else the file says of itself, such as its ``coordinate system``.
    radii
        Shape (n,), float64, above 0: radii of the discs that the file gives, in its own unit. None:
        the points' spacing tells them.
    up
        The axis that points up by the habit of the file's format.
    closing
        The closing radii, if they were found with the normals; ``measure_discs`` takes them. They
        are lost when a part of the cloud is replaced.
    """

    positions: npt.NDArray[np.float64]
    normals: npt.NDArray[np.float32]
    colours: npt.NDArray[np.uint8]
    two_sided: npt.NDArray[np.bool_]
    origin: npt.NDArray[np.float64]
    name: str
    dropped: dict[str, int]
    used: dict[str, str] = field(default_factory=dict)
    ignored: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    colour_key: dict[str, Any] = field(default_factory=dict)
    facts: dict[str, str] = field(default_factory=dict)
    radii: npt.NDArray[np.float64] | None = None
    up: str = "y"
    closing: Closing | None = field(default=None, init=False, repr=False)

    @property
    def survey(self) -> bool:
        """Whether the file has a surveyor's format: the ground and what stands on it, z up."""
        return self.up == "z"

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.positions)

    def turned(self, normals: npt.NDArray[np.float32], two_sided: npt.NDArray[np.bool_]) -> Cloud:
        """Return the same points with other normals; their order along the curve is kept."""
        cloud = replace(self, normals=normals, two_sided=two_sided)
        cloud.__dict__.update({key: vars(self)[key] for key in CACHED if key in vars(self)})
        return cloud

    def keep_closing(self, closing: Closing) -> None:
        """Keep the closing radii of the distinct points, which belong to the normals."""
        object.__setattr__(self, "closing", closing)

    @cached_property
    def curve(self) -> Curve:
        """The points along Morton's curve, sorted when it is first asked for."""
        return sort_along_curve(self.positions)

    @cached_property
    def cells(self) -> Cells:
        """The cells of the octree for searches of neighbours, made when first asked for."""
        return build_cells(self.positions, self.curve)
