"""Normals of a cell's points from their neighbourhoods: compiled code for one cell."""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from .cells import CELL_POINTS
from .neighbourhood import CANDIDATES, gather_candidates
from .thinnest import thinnest

__all__ = ["GROWTHS", "NOISY", "Workspace", "estimate_in_cell", "new_workspace", "take_around"]

NEIGHBOURS = 16
"""Points of a neighbourhood with the point itself, where the surface is smooth."""

SAME = 1e-6
"""Squares of distances that differ by this share count as the same."""

STEPS = 200
"""Most steps of a bisection; 100 halve the largest distance to the smallest that there is."""

BEYOND = 1e30
"""Square of a distance beyond all candidates, in units of the cell's size."""

WIDER_POINTS = 16
"""Most points that a wider neighbourhood takes of a cube."""

GROWTHS = 3
"""Times that a neighbourhood grows at most: first to all of the 27 cubes, then to cubes of twice
the size, and again."""

NOISY = 0.05
"""A neighbourhood grows if its smallest extent is above this share of the second (as variances):
what is scattered so far off a plane is noise, and more points average it."""

CLEARER = 0.35
"""A larger neighbourhood counts if its smallest extent has at most this part of the share that the
smaller one's had."""

THICK = 0.1
"""A neighbourhood whose share is larger may be as thick as it is wide, so that a larger one is
hardly clearer: the part is larger by what the share is above this."""

MOST_PART = 0.9
"""The largest part. At an edge, which looks the same at every size, it is 1."""

FLAT = 0.1
"""A neighbourhood is a line, not a plane, if its second extent is below this share of the first
(as variances: a third of its length). A scanner's line tells nothing of the slope across it. Such a
neighbourhood grows as well, and the larger one counts."""

REACH = 12.0
"""Square of the reach of all 27 cubes from a point in the middle one: two cubes along each axis, in
units of the cell's size. A point far from the bulk, which counts in an outermost cube, lies
beyond."""

WITHIN = 3.0
"""Square of the largest distance of two points of a cell in the same units; those further apart are
far from the bulk."""


class Workspace(NamedTuple):
    """Arrays that are used again for each cell.

    Parameters
    ----------
    found, around
        The candidates of the cell's neighbourhood, and their positions (see ``take_around``).
    squares, moments, vector
        Squares of their distances from a point: shape (``CANDIDATES``,). The covariance of the
        neighbours and the direction in which they are thinnest: shapes (6,) and (3,).
    thin, flat, todo
        Of each point of a cell: what share of its neighbourhood's extent is off the plane, whether
        the neighbourhood is a line, and whether it must grow: shape (``CELL_POINTS``,).
    """

    found: Any
    around: Any
    squares: Any
    moments: Any
    vector: Any
    thin: Any
    flat: Any
    todo: Any


@nb.njit
def new_workspace() -> Workspace:
    """Return room for a cell."""
    return Workspace(
        np.empty(CANDIDATES, np.int64), np.empty((3, CANDIDATES)), np.empty(CANDIDATES),
        np.empty(6), np.empty(3), np.zeros(CELL_POINTS), np.zeros(CELL_POINTS, np.bool_),
        np.zeros(CELL_POINTS, np.bool_),
    )  # fmt: skip


@nb.njit(error_model="numpy")
def estimate_in_cell(
    search: Any,
    positions: Any,
    start: int,
    stop: int,
    depth: int,
    needed: Any,
    count: int,
    growths: int,
    space: Workspace,
    normals: Any,
    shares: Any,
) -> None:
    """Set the normals of a cell's points that are needed.

    Parameters
    ----------
    search
        See ``search_of``.
    positions
        Of the distinct points: shape (m, 3).
    start, stop, depth
        The cell's first point and the one behind its last, and its level.
    needed
        Points whose normals are set: shape (m,), bool.
    count
        Candidates of the cell's neighbourhood.
    growths
        Times that a neighbourhood grows at most; see ``GROWTHS``.
    space
        Has the candidates and their positions. All of it is overwritten.
    normals
        Set: shape (m, 3), float32, of unit length; the sign means nothing.
    shares
        Set: what share of each neighbourhood's extent is off the plane, as variances: shape (m,),
        float32.
    """
    keys, levels, table, table_levels, _, _ = search
    found, around, squares, moments, vector, thin, flat, todo = space
    # In units of the cell's size, so that no square over- or underflows.
    scale = float(1 << depth)
    left = 0
    for i in range(start, stop):
        at = i - start
        todo[at] = False
        if not needed[i]:
            continue
        x, y, z = _offset(positions, i, start, scale)
        reach = _reach(around, count, x, y, z, squares)
        _moments(around, count, x, y, z, squares, reach, found, moments)
        least, middle, most = thinnest(moments, vector)
        for axis in range(3):
            normals[i, axis] = vector[axis]
        flat[at] = middle <= FLAT * most
        thin[at] = least / middle if middle > 0.0 else 0.0
        todo[at] = flat[at] or thin[at] > NOISY
        left += todo[at]
    for wider in range(growths):
        if left == 0 or wider > depth:
            break
        if wider > 0:
            count = gather_candidates(
                keys, levels, table, table_levels, start, depth - wider, WIDER_POINTS, found
            )
            take_around(positions, found, count, start, scale, around)
        left = _grow(positions, count, start, stop, scale, REACH * 4.0**wider, space, normals)
    for i in range(start, stop):
        if needed[i]:
            shares[i] = thin[i - start]


@nb.njit(error_model="numpy")
def _grow(
    positions: Any,
    count: int,
    start: int,
    stop: int,
    scale: float,
    reach: float,
    space: Workspace,
    normals: Any,
) -> int:
    """Set a cell's normals from all that is around; return how many points are still to do.

    Points of a cell have the same neighbourhood, so it is measured about the first of them. A point
    far from the bulk, which counts in an outermost cell, has its own.
    """
    found, around, squares, moments, vector, thin, flat, todo = space
    left = 0
    has_middle = False
    x, y, z, least, middle, most = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(start, stop):
        at = i - start
        if not todo[at]:
            continue
        a, b, c = _offset(positions, i, start, scale)
        if not has_middle or (a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2 > WITHIN:
            x, y, z, has_middle = a, b, c, True
            _set_squares(around, count, x, y, z, squares)
            _moments(around, count, x, y, z, squares, reach, found, moments)
            least, middle, most = thinnest(moments, vector)
        todo[at] = False
        # Noise is the same in a larger neighbourhood, relief is larger as well.
        part = min(CLEARER + max(thin[at] - THICK, 0.0), MOST_PART)
        if flat[at] or least < part * thin[at] * middle:
            for axis in range(3):
                normals[i, axis] = vector[axis]
            flat[at] = middle <= FLAT * most
            thin[at] = least / middle if middle > 0.0 else 0.0
            todo[at] = flat[at] or thin[at] > NOISY
        left += todo[at]
    return left


@nb.njit(inline="always")
def _offset(positions: Any, i: int, start: int, scale: float) -> tuple[float, float, float]:
    """Return a point's position relative to a cell's first point, in units of the cell's size."""
    return (
        (positions[i, 0] - positions[start, 0]) * scale,
        (positions[i, 1] - positions[start, 1]) * scale,
        (positions[i, 2] - positions[start, 2]) * scale,
    )


@nb.njit(error_model="numpy")
def take_around(
    positions: Any, found: Any, count: int, start: int, scale: float, around: Any
) -> None:
    """Set the candidates' positions relative to a cell's first point: shape (3, most)."""
    for c in range(count):
        around[0, c], around[1, c], around[2, c] = _offset(positions, found[c], start, scale)


# The sign of a zero does not matter, which lets LLVM make vectors of the counts.
@nb.njit(error_model="numpy", fastmath={"nsz"})
def _reach(around: Any, count: int, x: float, y: float, z: float, squares: Any) -> float:
    """Return the square of the distance of the last of the nearest ``NEIGHBOURS``, or a hair more.

    It is found by bisection, which needs some counts over all candidates. They are vectors, while a
    search for the nearest would branch at each.
    """
    _set_squares(around, count, x, y, z, squares)
    if count <= NEIGHBOURS:
        return BEYOND
    low, high = 0.0, BEYOND
    # If a surface passes through nine of the cubes.
    reach = 9.0 / np.pi * NEIGHBOURS / count
    for _ in range(STEPS):
        if high - low <= SAME * high:
            break
        inside = 0
        for c in range(count):
            inside += squares[c] <= reach
        if inside < NEIGHBOURS:
            low = reach
            reach = 2.0 * reach if high == BEYOND else 0.5 * (reach + high)
        elif inside > NEIGHBOURS:
            high = reach
            reach = 0.5 * (reach + low)
        else:
            return reach
    return high


@nb.njit(error_model="numpy")
def _set_squares(around: Any, count: int, x: float, y: float, z: float, squares: Any) -> None:
    """Set the square of each candidate's distance."""
    for c in range(count):
        dx, dy, dz = around[0, c] - x, around[1, c] - y, around[2, c] - z
        squares[c] = dx * dx + dy * dy + dz * dz


@nb.njit(error_model="numpy")
def _moments(
    around: Any,
    count: int,
    x: float,
    y: float,
    z: float,
    squares: Any,
    reach: float,
    inside: Any,
    moments: Any,
) -> None:
    """Set the covariance of the neighbours within a distance: xx, xy, xz, yy, yz, zz.

    The neighbours are listed first, in ``inside``, and added one after the other: the sums are the
    same to the bit wherever and however this is compiled.
    """
    number = 0
    for c in range(count):
        inside[number] = c
        number += squares[c] <= reach
    sx, sy, sz = 0.0, 0.0, 0.0
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(number):
        c = inside[k]
        dx, dy, dz = around[0, c] - x, around[1, c] - y, around[2, c] - z
        sx, sy, sz = sx + dx, sy + dy, sz + dz
        xx, xy, xz = xx + dx * dx, xy + dx * dy, xz + dx * dz
        yy, yz, zz = yy + dy * dy, yz + dy * dz, zz + dz * dz
    share = 1.0 / number
    moments[0] = xx - sx * sx * share
    moments[1] = xy - sx * sy * share
    moments[2] = xz - sx * sz * share
    moments[3] = yy - sy * sy * share
    moments[4] = yz - sy * sz * share
    moments[5] = zz - sz * sz * share
