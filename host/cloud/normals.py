"""Normals estimated from the neighbourhood of each point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .cells import Cells, build_cells
from .closing import Closing
from .cloud import Cloud
from .measure_cells import measure_cells

__all__ = ["estimate_normals", "estimate_surface"]

_Floats = npt.NDArray[np.float64]


def estimate_normals(
    positions: _Floats,
    wanted: npt.NDArray[np.bool_] | None = None,
    *,
    cells: Cells | None = None,
    progress: Callable[[float], None] | None = None,
) -> npt.NDArray[np.float32]:
    """Return the direction in which each point's neighbourhood is thinnest.

    It is the eigenvector of the smallest eigenvalue of the covariance of the nearest neighbours
    (Hoppe et al., "Surface reconstruction from unorganized points", 1992, section 3.2). Its sign
    means nothing. If the neighbours lie on a line or at one position, or scattered about the plane,
    more of them are taken. If they still lie on a line, the result is some unit vector across it.
    Normals of a cloud that is noisy all over are then smoothed
    (:mod:`splatline.host.cloud.smooth_normals`). Points in one smallest cube of the octree count
    once (:mod:`splatline.host.cloud.cells`).

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite.
    wanted
        Shape (n,), bool: the points whose normals are returned; all, if not given. Every point
        counts as a neighbour.
    cells
        The cells of the cloud; None: they are made here.
    progress
        Called now and then with the share of the work that is done.

    Returns
    -------
    ndarray
        Shape (m, 3), float32, unit vectors: a row for each point that is wanted, in order.
    """
    if wanted is None:
        wanted = np.ones(len(positions), np.bool_)
    if not wanted.any():
        return np.empty((0, 3), np.float32)
    if cells is None:
        cells = build_cells(positions)
    needed = np.zeros(len(cells.first), np.bool_)
    needed[cells.number[wanted]] = True
    normals = np.zeros((len(cells.first), 3), np.float32)
    measure_cells(cells, normals, needed, progress=progress)
    return normals[cells.number[wanted]]


def estimate_surface(cloud: Cloud, *, progress: Callable[[float], None] | None = None) -> None:
    """Set all normals of a cloud, and what ``measure_discs`` needs of its closing radii.

    Both come from one search of neighbours, and are bit for bit those that ``estimate_normals`` and
    then ``measure_discs`` find.

    Parameters
    ----------
    cloud
        The cloud; its normals and ``closing`` are set.
    progress
        Called now and then with the share of the work that is done.
    """
    cells = cloud.cells
    count = len(cells.first)
    normals, closing = np.zeros((count, 3), np.float32), Closing.empty(count)
    measure_cells(cells, normals, np.ones(count, np.bool_), closing, progress=progress)
    cloud.normals[:] = normals[cells.number]
    cloud.keep_closing(closing)
