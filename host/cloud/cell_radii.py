"""Closing radii of a cell's points: compiled code for one cell."""

from __future__ import annotations

import math
from typing import Any

import numba as nb
import numpy as np

from .closing import APART, closing_radius
from .pulls import pull_neighbours, weaken_other_side

__all__ = ["close_in_cell"]


@nb.njit(error_model="numpy")
def close_in_cell(
    positions: Any,
    normals: Any,
    start: int,
    stop: int,
    depth: int,
    few: bool,
    away: Any,
    facing: Any,
    count: int,
    signed: bool,
    pull: Any,
    waiting: Any,
    radii: Any,
    thin: Any,
) -> None:
    """Set the closing radii of a cell's points, and which of them are thin.

    Parameters
    ----------
    positions, normals
        Of the distinct points: shape (m, 3), float64 and float32.
    start, stop, depth
        The cell's first point and the one behind its last, and its level.
    few
        Whether each point is shown apart.
    away, facing, count
        Positions of the neighbourhood's points, see ``take_around``, and their normals if they are
        signed: shape (3, most), float32; and how many there are.
    signed
        Whether the normals tell a surface's outer side.
    pull, waiting
        Overwritten: see ``closing_radius``.
    radii, thin
        Set: shape (m,), float64 in units of the bulk's extent, and bool.
    """
    # In units of the cell's own size about its first point, so that float32 is enough.
    scale = float(1 << depth)
    for i in range(start, stop):
        x = np.float32((positions[i, 0] - positions[start, 0]) * scale)
        y = np.float32((positions[i, 1] - positions[start, 1]) * scale)
        z = np.float32((positions[i, 2] - positions[start, 2]) * scale)
        normal = normals[i, 0], normals[i, 1], normals[i, 2]
        pull_neighbours(away, count, (x, y, z), normal, pull)
        if signed:
            weaken_other_side(facing, count, normal, pull)
        radius, closes = closing_radius(pull, count, waiting)
        if few or radius == np.inf:  # then its neighbours are straight above and below it
            radius, closes = APART * _nearest(away, count, x, y, z), False
        thin[i] = not closes
        radii[i] = radius / scale


@nb.njit(error_model="numpy")
def _nearest(away: Any, count: int, x: float, y: float, z: float) -> float:
    """Return the distance of the nearest other point of a neighbourhood."""
    least = np.inf
    for c in range(count):
        dx, dy, dz = away[0, c] - x, away[1, c] - y, away[2, c] - z
        square = dx * dx + dy * dy + dz * dz
        if 0.0 < square < least:
            least = square
    return math.sqrt(least) if least < np.inf else 1.0
