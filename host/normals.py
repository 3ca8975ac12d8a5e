"""Normals of points that came without: the plane through the nearest neighbours."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["estimate_normals"]

NEIGHBOURS = 16
"""Points that a plane is fitted to, the point itself included."""

CHUNK = 1 << 16
"""Points handled at once, to bound the memory."""


def estimate_normals(
    positions: npt.NDArray[np.float64],
    wanted: npt.NDArray[np.bool_] | None = None,
    neighbours: int = NEIGHBOURS,
) -> npt.NDArray[np.float32]:
    """Estimate normals by principal component analysis.

    The normal is the eigenvector of the smallest eigenvalue of the neighbours' covariance (Hoppe et
    al., *Surface Reconstruction from Unorganized Points*, 1992). Its sign means nothing. Where the
    neighbours lie on one line it is some direction across the line; where they are one point, or
    there is no neighbour at all, the z axis.

    Parameters
    ----------
    positions
        Shape (n, 3), finite.
    wanted
        Shape (n,): the points to estimate for; all if not given. The others still are neighbours.
    neighbours
        Points to fit to, the point itself included.

    Returns
    -------
    numpy.ndarray
        Shape (m, 3), float32, of unit length: one row for each point wanted.
    """
    from scipy.spatial import cKDTree

    targets = positions if wanted is None else positions[wanted]
    normals = np.zeros((len(targets), 3), np.float32)
    normals[:, 2] = 1.0
    count = min(neighbours, len(positions))
    if count < 2:
        return normals
    tree = cKDTree(positions)
    for begin in range(0, len(targets), CHUNK):
        part = slice(begin, begin + CHUNK)
        _, index = tree.query(targets[part], k=count, workers=-1)
        around = positions[index]
        around -= around.mean(axis=1, keepdims=True)
        # Brought to a common size, so that no square overflows or vanishes.
        reach = np.abs(around).max(axis=(1, 2))
        spread = reach > 0.0
        around = around[spread] / reach[spread, np.newaxis, np.newaxis]
        covariance = np.swapaxes(around, 1, 2) @ around
        _, vectors = np.linalg.eigh(covariance)  # eigenvalues ascending
        normals[part][spread] = vectors[:, :, 0]
    return normals
