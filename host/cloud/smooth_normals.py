"""Smooth normals of a noisy cloud: mean axes of the normals about each point, for one cell."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from .cell_normals import NOISY, Workspace
from .thinnest import thinnest

__all__ = ["is_noisy", "smooth_in_cell", "trust_in"]

FLATTEST = 0.1
"""Part of a cloud's neighbourhoods that may be flat although it is noisy. Relief is not everywhere,
so a cloud without noise has more."""

AROUND = 32
"""Points within the reach of a mean, where a surface passes through nine of the 27 cubes."""

DOUBT = 30.0
"""A neighbourhood whose share of thickness is 1 counts 1 + ``DOUBT`` times less than a flat one."""


def is_noisy(shares: npt.NDArray[np.float32]) -> bool:
    """Return whether a cloud has noise all over: whether nearly all neighbourhoods are thick.

    Parameters
    ----------
    shares
        Shares of thickness of some of its points, see ``estimate_in_cell``: shape (n,), n at least
        1.
    """
    return bool(np.quantile(shares, FLATTEST) > NOISY)


def trust_in(shares: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return how much each normal counts in a mean, from its share of thickness: shape (n,)."""
    return np.float32(1.0) / (np.float32(1.0) + np.float32(DOUBT) * shares)


@nb.njit(error_model="numpy")
def smooth_in_cell(
    start: int,
    stop: int,
    needed: Any,
    away: Any,
    count: int,
    space: Workspace,
    rough: Any,
    trust: Any,
    weights: Any,
    near: Any,
    normals: Any,
) -> None:
    """Set the normals of a cell's points that are needed to mean axes of those about them.

    The mean of axes, whose signs mean nothing, is the eigenvector of the largest eigenvalue of the
    sum of their outer products (Mardia and Jupp, *Directional Statistics*, 2000). An axis counts
    more the nearer it is, and the flatter its own neighbourhood.

    Parameters
    ----------
    start, stop
        The cell's first point and the one behind its last.
    needed
        Points whose normals are set: shape (m,), bool.
    away, count
        Positions of the neighbourhood's points, see ``take_around``: shape (3, most), float32; and
        how many there are.
    space
        Has the points' numbers. The rest is overwritten.
    rough, trust
        The normals, and how much each counts: shapes (m, 3) and (m,), float32.
    weights, near
        Overwritten: shape (``CANDIDATES``,), float32 and int64.
    normals
        Set: shape (m, 3), float32, of unit length.
    """
    found, moments, vector = space.found, space.moments, space.vector
    inverse = np.float32(np.pi / 9.0 / AROUND * count)
    own = 0
    while found[own] != start:  # the candidates have the cell's points in order
        own += 1
    for i in range(start, stop):
        if not needed[i]:
            continue
        at = own + i - start
        _weigh(away, count, away[0, at], away[1, at], away[2, at], inverse, weights)
        inside = 0
        for c in range(count):  # without a branch, which would be guessed wrong
            near[inside] = c
            inside += weights[c] > np.float32(0.0)
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(inside):
            c = near[k]
            j = found[c]
            x, y, z = float(rough[j, 0]), float(rough[j, 1]), float(rough[j, 2])
            weight = float(weights[c] * weights[c] * trust[j])
            xx, xy, xz = xx + weight * x * x, xy + weight * x * y, xz + weight * x * z
            yy, yz, zz = yy + weight * y * y, yz + weight * y * z, zz + weight * z * z
        # The largest eigenvalue of a sum is the least of what the sum's trace has more.
        moments[0], moments[1], moments[2] = yy + zz, -xy, -xz
        moments[3], moments[4], moments[5] = xx + zz, -yz, xx + yy
        thinnest(moments, vector)
        for axis in range(3):
            normals[i, axis] = vector[axis]


@nb.njit(error_model="numpy")
def _weigh(
    away: Any, count: int, x: float, y: float, z: float, inverse: float, weights: Any
) -> None:
    """Set the root of each candidate's weight: 1 at the point, below 0 beyond the reach."""
    for c in range(count):
        dx, dy, dz = away[0, c] - x, away[1, c] - y, away[2, c] - z
        weights[c] = np.float32(1.0) - (dx * dx + dy * dy + dz * dz) * inverse
