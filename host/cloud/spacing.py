"""The radii of discs that close a surface, from the spacing of the points within it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .cells import Cells, build_cells, parts_of, search_of
from .closing import APART, COSINES, DIRECTIONS, SINES, closing_radius, pull_neighbours, strongest
from .cloud import Cloud
from .neighbourhood import CANDIDATES, CUBE_POINTS, gather_candidates
from .prefetch import AHEAD, prefetch

__all__ = ["Discs", "closing_radii", "measure_discs", "splat_radii"]

COVER = 1.32
"""Radius of a disc for a closing radius of 1. Neighbours lie off the disc's plane, so that discs of
the closing radius itself leave gaps where a surface bends or is noisy. Smaller ones leave more
holes, larger ones blur small relief (decision 0064)."""

MOST_UNEVEN = 3.0
"""A closing radius is at most this many times the median about it."""

AROUND = 32
"""Points before and after a cell along the curve, every fourth of which counts for that median."""

SINGLE = 0.01
"""Closing radius of a cloud whose points are all at one position."""

FEWEST = 12
"""Fewer points make no surface. Each is shown apart."""

_Floats = npt.NDArray[np.float64]


class Discs(NamedTuple):
    """The discs of a cloud.

    Parameters
    ----------
    radii
        In the cloud's unit: shape (n,), float64, above 0.
    thin
        Which points have no gap about them that a surface would have, as on a curve or alone: shape
        (n,), bool. Such a point is drawn as one pixel where its disc covers no pixel's centre.
    """

    radii: _Floats
    thin: npt.NDArray[np.bool_]


def splat_radii(
    cloud: Cloud, size: float | None = None, *, progress: Callable[[float], None] | None = None
) -> _Floats:
    """Return the radius of each point's disc; see :func:`measure_discs`."""
    return measure_discs(cloud, size, progress=progress).radii


def measure_discs(
    cloud: Cloud, size: float | None = None, *, progress: Callable[[float], None] | None = None
) -> Discs:
    """Return the discs of a cloud.

    Parameters
    ----------
    cloud
        The points; at least one.
    size
        Diameter of all discs, in the cloud's unit. None: the cloud's own radii if it has them;
        else the discs close the surface: each is ``COVER`` times as large as its closing radius
        (see :func:`closing_radii`).
    progress
        Called now and then with the share of the work that is done.

    Raises
    ------
    InputError
        If ``size`` is not a finite number above 0.
    """
    if size is None and cloud.radii is not None:
        return Discs(cloud.radii, np.zeros(len(cloud), np.bool_))
    if size is None:
        radii, thin = _close(cloud.cells, cloud.normals, progress)
        return Discs(COVER * radii, thin)
    if not (math.isfinite(size) and size > 0.0):
        raise InputError(f"the splat size must be above 0, not {size:g}")
    return Discs(np.full(len(cloud), 0.5 * size), np.zeros(len(cloud), np.bool_))


def closing_radii(
    positions: _Floats,
    normals: npt.NDArray[np.float32],
    *,
    progress: Callable[[float], None] | None = None,
) -> _Floats:
    """Return the radii at which discs in the points' tangent planes just close the surface.

    In the tangent plane of a point, the middles of the gaps between it and its neighbours are the
    corners of its Voronoi region. Its disc must reach the furthest of them
    (:mod:`splatline.host.cloud.closing`). Density plays no part, so duplicates and lines of a
    scanner do not make discs too small. A disc at the border of a surface closes gaps on its inner
    side alone. Points in one smallest cube of the octree count once. A radius is at most
    ``MOST_UNEVEN`` times the median about the point, so that a stray point stays small.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite; n at least 1.
    normals
        Shape (n, 3), float32, of unit length.
    progress
        Called now and then with the share of the work that is done.

    Returns
    -------
    ndarray
        Shape (n,), float64, above 0: ``SINGLE`` if all points are at one position.
    """
    return _close(build_cells(positions), normals, progress).radii


def _close(
    cells: Cells,
    normals: npt.NDArray[np.float32],
    progress: Callable[[float], None] | None,
) -> Discs:
    """Return the discs that just close a surface; see :func:`closing_radii`."""
    count = len(cells.number)
    if len(cells.first) == 1:
        return Discs(np.full(count, SINGLE), np.ones(count, np.bool_))
    raw, thin = np.empty(len(cells.first)), np.empty(len(cells.first), np.bool_)
    arrays = cells.positions, normals, cells.first, COSINES, SINES, raw, thin
    few = len(cells.first) < FEWEST
    for cuts in parts_of(cells, progress):
        _measure(search_of(cells), cuts, few, *arrays)
    even, alone = np.empty_like(raw), np.empty_like(thin)
    for cuts in parts_of(cells):
        _even_out(cells.starts, cuts, raw, thin, even, alone)
    radii = np.empty(count)
    _spread_out(even, cells.number, cells.unit, radii)
    return Discs(radii, alone[cells.number])


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _measure(
    search: Any,
    cuts: Any,
    few: bool,
    positions: Any,
    normals: Any,
    first: Any,
    cosines: Any,
    sines: Any,
    radii: Any,
    thin: Any,
) -> None:
    """Set each distinct point's closing radius, in units of the bulk's extent, and if it is thin.

    Points of a cloud that has ``few`` are shown apart.
    """
    keys, levels, table, table_levels, starts, depths = search
    for chunk in nb.prange(len(cuts) - 1):
        found = np.empty(CANDIDATES, np.int64)
        away = np.empty((3, CANDIDATES), np.float32)
        pull = np.empty((2, CANDIDATES), np.float32)
        most, sides = np.empty(DIRECTIONS, np.float32), np.empty((2, DIRECTIONS + 1), np.float32)
        for cell in range(cuts[chunk], cuts[chunk + 1]):
            start, depth = starts[cell], depths[cell]
            count = gather_candidates(
                keys, levels, table, table_levels, start, depth, CUBE_POINTS, found
            )
            # In units of the cell's own size about its first point, so that float32 is enough.
            scale = float(1 << depth)
            for c in range(count):
                for axis in range(3):
                    offset = positions[found[c], axis] - positions[start, axis]
                    away[axis, c] = offset * scale
            for i in range(start, starts[cell + 1]):
                x = np.float32((positions[i, 0] - positions[start, 0]) * scale)
                y = np.float32((positions[i, 1] - positions[start, 1]) * scale)
                z = np.float32((positions[i, 2] - positions[start, 2]) * scale)
                point = first[i]
                prefetch(normals, 12 * first[min(i + AHEAD, len(first) - 1)])
                normal = normals[point, 0], normals[point, 1], normals[point, 2]
                pull_neighbours(away, count, (x, y, z), normal, pull)
                strongest(pull[0], pull[1], count, cosines, sines, most)
                radius, closes = closing_radius(pull, most, sides)
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


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _even_out(starts: Any, cuts: Any, raw: Any, thin: Any, even: Any, alone: Any) -> None:
    """Limit each radius by the median of those about its cell, along the curve.

    A thin point among points of a surface belongs to the surface, as a chance of its sampling.
    """
    for chunk in nb.prange(len(cuts) - 1):
        for cell in range(cuts[chunk], cuts[chunk + 1]):
            start, stop = starts[cell], starts[cell + 1]
            first, last = max(start - AROUND, 0), min(stop + AROUND, len(raw))
            around = raw[first:last:4]
            share = 0
            for i in range(first, last):
                share += thin[i]
            is_surface = 2 * share < last - first
            most = raw[start:stop].max()
            # Sorting takes time. Where more than half are large enough, so is the median.
            enough = 0
            for i in range(len(around)):
                enough += MOST_UNEVEN * around[i] >= most
            limit = most if 2 * enough > len(around) + 1 else MOST_UNEVEN * np.median(around)
            for i in range(start, stop):
                even[i] = min(raw[i], limit)
                alone[i] = thin[i] and not is_surface


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _spread_out(even: Any, number: Any, unit: float, radii: Any) -> None:
    """Set every point's radius in the cloud's unit."""
    for i in nb.prange(len(radii)):
        prefetch(even, 8 * number[min(i + AHEAD, len(number) - 1)])
        radii[i] = even[number[i]] * unit
