"""The spacing of a cloud's points, and the radii of discs that close the surface."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .cloud import Cloud

__all__ = ["point_spacing", "splat_radii"]

NEIGHBOURS = 8
"""Nearest other positions from which a point's spacing is measured."""

MOST_UNEVEN = 2.0
"""A point's spacing is at most this many times the median of its neighbours'."""

COVER = 1.0
"""Radius of a disc for a spacing of 1. A square grid is closed from 0.71 on; symmetric shapes, with
positions and sizes of whole pixels, need more. Below 1.0 holes multiply, above it small relief
blurs."""

CHUNK = 1 << 17
"""Points at a time, so that the neighbours of a large cloud fit the memory."""

_Floats = npt.NDArray[np.float64]


def splat_radii(cloud: Cloud, size: float | None = None) -> _Floats:
    """Return the radius of each point's disc.

    Parameters
    ----------
    cloud
        The points; at least one.
    size
        Diameter of all discs, in the cloud's unit. None: each disc is ``2 COVER`` times as wide
        as the spacing of the points about it (see ``point_spacing``), so that neighbours overlap
        just enough to close the surface.

    Returns
    -------
    ndarray
        Shape (n,), float64, above 0, in the cloud's unit.

    Raises
    ------
    InputError
        If ``size`` is not a finite number above 0.
    """
    if size is None:
        return COVER * point_spacing(cloud.positions)
    if not (math.isfinite(size) and size > 0.0):
        raise InputError(f"the splat size must be above 0, not {size:g}")
    return np.full(len(cloud), 0.5 * size)


def point_spacing(positions: _Floats) -> _Floats:
    """Return the distance between neighbours on the surface about each point.

    The k nearest other positions of a point lie in a disc whose radius d is the distance to the
    farthest of them. Each has an area of pi d^2 / k, and the spacing is the side of a square of
    that area. It is steadier than the distance to the nearest point, which is short by chance.
    Points at one position count once. The spacing is at most ``MOST_UNEVEN`` times the median of
    the neighbours' spacings, so that a stray point does not get a large disc.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite; n at least 1.

    Returns
    -------
    ndarray
        Shape (n,), float64, above 0: 1 % of a unit if all points are at one position.
    """
    from scipy.spatial import cKDTree

    extent = float(np.ptp(positions, axis=0).max())
    if extent == 0.0:
        return np.full(len(positions), 0.01)
    # In units of the cloud's own size, so that no square over- or underflows.
    distinct, number = _distinct(positions / extent)
    tree = cKDTree(distinct)
    neighbours = min(NEIGHBOURS, len(distinct) - 1)
    index = np.empty((len(distinct), neighbours), np.int32)
    reach = np.empty(len(distinct))
    for start in range(0, len(distinct), CHUNK):
        part = slice(start, start + CHUNK)
        # The nearest position is the point itself.
        distance, nearest = tree.query(distinct[part], neighbours + 1, workers=-1)
        reach[part], index[part] = distance[:, -1], nearest[:, 1:]
    spacing = reach * math.sqrt(math.pi / neighbours)
    usual = np.empty_like(spacing)
    for start in range(0, len(distinct), CHUNK):
        part = slice(start, start + CHUNK)
        usual[part] = np.median(spacing[index[part]], axis=1)
    spacing = np.minimum(spacing, MOST_UNEVEN * usual) * extent
    return spacing if number is None else spacing[number]


def _distinct(positions: _Floats) -> tuple[_Floats, npt.NDArray[Any] | None]:
    """Return the distinct positions, and the number of each point's; None if all are distinct."""
    order = np.lexsort(positions.T)
    ordered = positions[order]
    fresh = np.ones(len(positions), np.bool_)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    if fresh.all():
        return positions, None
    number = np.empty(len(positions), np.int64)
    number[order] = np.cumsum(fresh) - 1
    return ordered[fresh], number
