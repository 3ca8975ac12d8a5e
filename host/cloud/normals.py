"""Normals estimated from the neighbourhood of each point."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from .cells import CELL_POINTS, build_cells, chunks_of, search_of
from .neighbourhood import CANDIDATES, gather_candidates
from .thinnest import thinnest

__all__ = ["estimate_normals"]

NEIGHBOURS = 16
"""Points of a neighbourhood with the point itself, where the surface is smooth."""

MOST_NEIGHBOURS = 256
"""Most points of a neighbourhood that had to grow."""

GROWTHS = 3
"""Times that a neighbourhood grows at most: first to all of the 27 cubes, then to cubes of twice
the size, and again."""

NOISY = 0.05
"""A neighbourhood grows if its smallest extent is above this share of the second (as variances):
what is scattered so far off a plane is noise, and more points average it."""

CLEARER = 0.35
"""A larger neighbourhood counts if its smallest extent has at most this part of the share that the
smaller one's had."""

FLAT = 1e-6
"""A neighbourhood is a line, not a plane, if its second extent is below this share of the first
(as variances: its square root is 1e-3). It grows as well."""

_Floats = npt.NDArray[np.float64]


def estimate_normals(
    positions: _Floats, wanted: npt.NDArray[np.bool_] | None = None
) -> npt.NDArray[np.float32]:
    """Return the direction in which each point's neighbourhood is thinnest.

    It is the eigenvector of the smallest eigenvalue of the covariance of the nearest neighbours
    (Hoppe et al., "Surface reconstruction from unorganized points", 1992, section 3.2). Its sign
    means nothing. If the neighbours lie on a line or at one position, or scattered about the plane,
    more of them are taken. If they still lie on a line, the result is some unit vector across it.
    Points in one smallest cube of the octree count once (:mod:`splatline.host.cloud.cells`).

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite.
    wanted
        Shape (n,), bool: the points whose normals are returned; all, if not given. Every point
        counts as a neighbour.

    Returns
    -------
    ndarray
        Shape (m, 3), float32, unit vectors: a row for each point that is wanted, in order.
    """
    if wanted is None:
        wanted = np.ones(len(positions), np.bool_)
    if not wanted.any():
        return np.empty((0, 3), np.float32)
    cells = build_cells(positions)
    needed = np.zeros(len(cells.first), np.bool_)
    needed[cells.number[wanted]] = True
    normals = np.zeros((len(cells.first), 3), np.float32)
    _estimate(search_of(cells), chunks_of(cells), cells.positions, needed, normals)
    return normals[cells.number[wanted]]


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _estimate(search: Any, cuts: Any, positions: Any, needed: Any, normals: Any) -> None:
    """Set the normal of each distinct point that is needed."""
    keys, levels, table, table_levels, starts, depths = search
    for chunk in nb.prange(len(cuts) - 1):
        found = np.empty(CANDIDATES, np.int64)
        around = np.empty((CANDIDATES, 3))
        nearest, moments, vector = np.empty(NEIGHBOURS), np.empty(6), np.empty(3)
        thin, flat = np.zeros(CELL_POINTS), np.zeros(CELL_POINTS, np.bool_)
        todo = np.zeros(CELL_POINTS, np.bool_)
        for cell in range(cuts[chunk], cuts[chunk + 1]):
            start, stop, depth = starts[cell], starts[cell + 1], depths[cell]
            left = 0
            for i in range(start, stop):
                todo[i - start] = needed[i]
                left += needed[i]
            count = 0
            for growth in range(GROWTHS + 1):
                wider = max(growth - 1, 0)
                if left == 0 or wider > depth:
                    break
                if growth != 1:  # that has the same cubes, all of their points
                    count = gather_candidates(
                        keys, levels, table, table_levels, start, depth - wider, found
                    )
                    if growth > 1:
                        count = _thin_out(found, count)
                    # In units of the cell's size, so that no square over- or underflows.
                    scale = float(1 << depth)
                    for c in range(count):
                        for axis in range(3):
                            offset = positions[found[c], axis] - positions[start, axis]
                            around[c, axis] = offset * scale
                left = 0
                for i in range(start, stop):
                    at = i - start
                    if not todo[at]:
                        continue
                    x = (positions[i, 0] - positions[start, 0]) * float(1 << depth)
                    y = (positions[i, 1] - positions[start, 1]) * float(1 << depth)
                    z = (positions[i, 2] - positions[start, 2]) * float(1 << depth)
                    # Two cubes along each axis. A point far from the bulk, which counts in an
                    # outermost cube, lies beyond.
                    reach = 12.0 * 4.0**wider
                    if growth == 0:
                        reach = _reach(around, count, x, y, z, nearest)
                    _moments(around, count, x, y, z, reach, moments)
                    least, middle, most = thinnest(moments, vector)
                    todo[at] = False
                    # Noise is the same in a larger neighbourhood, relief is larger as well.
                    if growth == 0 or flat[at] or least < CLEARER * thin[at] * middle:
                        for axis in range(3):
                            normals[i, axis] = vector[axis]
                        flat[at] = middle <= FLAT * most
                        thin[at] = least / middle if middle > 0.0 else 0.0
                        todo[at] = flat[at] or thin[at] > NOISY
                    left += todo[at]


@nb.njit(error_model="numpy")
def _thin_out(found: Any, count: int) -> int:
    """Keep at most ``MOST_NEIGHBOURS`` candidates, evenly; return how many."""
    kept = min(count, MOST_NEIGHBOURS)
    for c in range(kept):
        found[c] = found[c * count // kept]
    return kept


@nb.njit(error_model="numpy")
def _reach(around: Any, count: int, x: float, y: float, z: float, nearest: Any) -> float:
    """Return the square of the distance of the last of the nearest ``NEIGHBOURS``."""
    size = min(count, NEIGHBOURS)
    nearest[:] = np.inf
    worst = np.inf
    for c in range(count):
        dx, dy, dz = around[c, 0] - x, around[c, 1] - y, around[c, 2] - z
        square = dx * dx + dy * dy + dz * dz
        if square < worst:
            at = size - 1
            while at > 0 and nearest[at - 1] > square:
                nearest[at] = nearest[at - 1]
                at -= 1
            nearest[at] = square
            worst = nearest[size - 1]
    return worst


@nb.njit(error_model="numpy")
def _moments(
    around: Any, count: int, x: float, y: float, z: float, reach: float, moments: Any
) -> None:
    """Set the covariance of the neighbours within a distance: xx, xy, xz, yy, yz, zz."""
    number = 0
    sx, sy, sz = 0.0, 0.0, 0.0
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(count):
        dx, dy, dz = around[c, 0] - x, around[c, 1] - y, around[c, 2] - z
        if dx * dx + dy * dy + dz * dz <= reach:
            number += 1
            sx, sy, sz = sx + dx, sy + dy, sz + dz
            xx, xy, xz = xx + dx * dx, xy + dx * dy, xz + dx * dz
            yy, yz, zz = yy + dy * dy, yz + dy * dz, zz + dz * dz
    share = 1.0 / number
    moments[0], moments[3], moments[5] = (
        xx - sx * sx * share,
        yy - sy * sy * share,
        zz - sz * sz * share,
    )
    moments[1], moments[2], moments[4] = (
        xy - sx * sy * share,
        xz - sx * sz * share,
        yz - sy * sz * share,
    )
