"""Normals estimated from the neighbourhood of each point."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["estimate_normals"]

NEIGHBOURS = 16
"""Points of a neighbourhood with the point itself: enough to average a scanner's noise."""

MOST_NEIGHBOURS = 256
"""Most points of a neighbourhood, which grows while its points lie on a line or at one position."""

CHUNK = 1 << 16
"""Points at a time, so that the neighbourhoods of a large cloud fit the memory."""

FLAT = 1e-6
"""A neighbourhood is a line, not a plane, if its second extent is below this share of the first
(as variances: its square root is 1e-3)."""

_Floats = npt.NDArray[np.float64]


def estimate_normals(
    positions: _Floats, wanted: npt.NDArray[np.bool_] | None = None
) -> npt.NDArray[np.float32]:
    """Return the direction in which each point's neighbourhood is thinnest.

    It is the eigenvector of the smallest eigenvalue of the covariance of the nearest neighbours
    (Hoppe et al., "Surface reconstruction from unorganized points", 1992, section 3.2). Its sign
    means nothing. If the neighbours lie on a line or at one position, more of them are taken. If
    that does not help, the result is some unit vector across the points.

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
    from scipy.spatial import cKDTree

    points = positions if wanted is None else positions[wanted]
    normals = np.empty((len(points), 3), np.float32)
    if not len(points):
        return normals
    # In units of the cloud's own size, so that no square over- or underflows.
    extent = float(np.ptp(positions, axis=0).max())
    unit = extent if extent > 0.0 else 1.0
    tree = cKDTree(positions / unit)
    for start in range(0, len(points), CHUNK):
        part = points[start : start + CHUNK] / unit
        normals[start : start + CHUNK] = _estimate(part, tree)
    return normals


def _estimate(points: _Floats, tree: object) -> _Floats:
    """Return the normals of some points, given the tree of all."""
    count = len(tree.data)  # type: ignore[attr-defined]
    neighbours = min(NEIGHBOURS, count)
    normals, flat = _fit(points, tree, neighbours)
    # Growing by steps keeps the few neighbourhoods that need it small.
    while neighbours < min(MOST_NEIGHBOURS, count) and flat.any():
        neighbours = min(4 * neighbours, MOST_NEIGHBOURS, count)
        again = np.flatnonzero(flat)
        for start in range(0, len(again), CHUNK // 16):
            part = again[start : start + CHUNK // 16]
            normals[part], flat[part] = _fit(points[part], tree, neighbours)
    return normals


def _fit(points: _Floats, tree: object, neighbours: int) -> tuple[_Floats, npt.NDArray[np.bool_]]:
    """Return normals, and where the neighbourhood is a line or a position."""
    _, index = tree.query(points, neighbours, workers=-1)  # type: ignore[attr-defined]
    index = index.reshape(len(points), neighbours)  # scipy drops the axis for one neighbour
    around = tree.data[index] - points[:, np.newaxis]  # type: ignore[attr-defined]
    # Each neighbourhood by itself in units of its own size: a dense spot must not underflow.
    reach = np.abs(around).max(axis=(1, 2), keepdims=True)
    around /= np.where(reach > 0.0, reach, 1.0)
    around -= around.mean(axis=1, keepdims=True)
    values, vectors = np.linalg.eigh(around.transpose(0, 2, 1) @ around)
    return vectors[:, :, 0], values[:, 1] <= FLAT * values[:, 2]
