"""The distances between which the discs of splats lie: of their rims, not of their centres."""

from __future__ import annotations

import math
from typing import Any

import numba as nb
import numpy as np

from splatline.host.compiled_cache import cached_njit

from .splats import DEPTH, DIAMETER, SLOPE_X, SLOPE_Y, Splats
from .view import View

__all__ = ["depth_extent"]

BESIDE = 0.5
"""Pixels beyond a disc's rim that count as its own: a disc that covers no pixel's centre is drawn
as the nearest pixel, and steep slopes are rounded coarsely."""

ROUNDING = 2.0
"""Levels by which the rounding of flat slopes may move a pixel away from its plane: half a step of
a quarter of a level over 14 pixels, 1.75, and half a unit of Z."""


def depth_extent(splats: Splats, view: View, levels: int) -> tuple[float, float]:
    """Return the least and the greatest distance along the view of any disc.

    With n' as in :func:`splatline.host.visibility.project.project` the distance changes by
    |n'| / sqrt(1 + |n'|^2) of the radius from the centre of a disc to its rim.

    Parameters
    ----------
    splats
        The splats.
    view
        The view: its focal length and its near distance, before which nothing counts.
    levels
        Levels of depth in the range; the furthest disc ends ``ROUNDING`` before the last.

    Returns
    -------
    tuple of float
        In the cloud's unit; (0, 0) if there is no splat.
    """
    if not len(splats):
        return 0.0, 0.0
    floats, _, doubles = splats.views()
    limits = np.empty((len(splats.starts), 2))
    _extents(floats, doubles, splats.starts, splats.stops, 1.0 / view.focal, limits)
    low, high = max(float(limits[:, 0].min()), view.near), float(limits[:, 1].max())
    return low, high + (high - low) * ROUNDING / levels


@cached_njit(parallel=True, error_model="numpy")
def _extents(
    floats: Any, doubles: Any, starts: Any, stops: Any, inverse_focal: float, limits: Any
) -> None:
    """Set the limits of each chunk, shape (chunks, 2); of an empty one they are infinite."""
    for chunk in nb.prange(len(starts)):
        low, high = np.inf, -np.inf
        for i in range(starts[chunk], stops[chunk]):
            slope_x, slope_y = float(floats[i, SLOPE_X]), float(floats[i, SLOPE_Y])
            square = slope_x * slope_x + slope_y * slope_y
            # Of a slope that overflows the share is 1.
            share = math.sqrt(square / (1.0 + square)) if square < 1e30 else 1.0
            depth = doubles[i, DEPTH]
            reach = (0.5 * float(floats[i, DIAMETER]) + BESIDE) * depth * inverse_focal * share
            low, high = min(low, depth - reach), max(high, depth + reach)
        limits[chunk, 0], limits[chunk, 1] = low, high
