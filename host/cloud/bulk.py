"""The bulk of a cloud, and the few points that lie far from it."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

from .cloud import Cloud

__all__ = ["bounds", "far_points", "lost_points", "select", "without_far_points"]

SHARE = 0.01
"""Share of the points at each end of an axis that the size of the bulk does not depend on."""

FEWEST = 8
"""Points of the smallest cloud that has a bulk."""

FAR = 3.0
"""Least distance of a far point from the bulk, in sizes of the bulk."""

GAP = 2.0
"""A far point lies at least this many times as far from the bulk as the points before it, so that
a scan that thins out with distance has none."""

LOST = 1e9
"""A lost point lies at least this many times as far from the middle as the nearest quarter does."""

NO_SCANNER = 1e15
"""Its least distance, whatever the unit."""

SAMPLE = 100_000
"""Points from which the bulk is measured."""

_Floats = npt.NDArray[np.float64]


def bounds(positions: _Floats) -> tuple[_Floats, _Floats]:
    """Return the lowest and the highest coordinates: shape (3,) each.

    Column by column, in which numpy is several times as fast as along the first axis.
    """
    return (
        np.array([column.min() for column in positions.T]),
        np.array([column.max() for column in positions.T]),
    )


def far_points(positions: _Floats) -> npt.NDArray[np.bool_]:
    """Return which points lie far from the bulk: strays, and values that stand for no return.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite.

    Returns
    -------
    ndarray
        Shape (n,), bool.
    """
    beyond = _beyond_bulk(positions)
    if beyond is None:
        return np.zeros(len(positions), np.bool_)
    outside = np.sort(beyond[beyond > 1.0])
    before = np.concatenate([[1.0], outside[:-1]])
    starts = np.flatnonzero((outside > FAR) & (outside > GAP * before))
    if not len(starts):
        return np.zeros(len(positions), np.bool_)
    return beyond >= outside[starts[0]]


def lost_points(positions: _Floats) -> npt.NDArray[np.bool_]:
    """Return which points hold a value that stands for no return, such as 1e30.

    They may be up to half of the points.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite.

    Returns
    -------
    ndarray
        Shape (n,), bool.
    """
    lost = np.zeros(len(positions), np.bool_)
    if max(float(positions.max()), -float(positions.min())) < NO_SCANNER:
        return lost
    distance = np.abs(positions - np.median(positions, axis=0)).max(axis=1)
    usual = float(np.quantile(distance, 0.25))
    if usual > 0.0:
        lost |= distance > max(NO_SCANNER, LOST * usual)
    return lost


def _beyond_bulk(positions: _Floats) -> _Floats | None:
    """Return how far each point lies outside the box of the bulk, in sizes of the bulk.

    The box holds 98 % of the points on each axis, and its size is its longest side. None: no point
    lies far outside, or there is no bulk, as most points are at one position.
    """
    count = len(positions)
    if count < FEWEST:
        return None
    sample = positions[:: max(1, count // SAMPLE)]
    rank = max(1, int(np.ceil(SHARE * len(sample))))
    ordered = np.partition(sample, (rank, len(sample) - 1 - rank), axis=0)
    low, high = ordered[rank], ordered[len(sample) - 1 - rank]
    size = float((high - low).max())
    if size == 0.0 or not np.isfinite(size):
        return None
    lowest, highest = bounds(positions)
    reach = max(float(((low - lowest) / size).max()), float(((highest - high) / size).max()))
    if reach <= FAR:
        return None
    outside = np.maximum(low - positions, positions - high) / size
    farthest: _Floats = np.maximum(outside.max(axis=1), 0.0)
    return farthest


def select(cloud: Cloud, kept: npt.NDArray[Any]) -> Cloud:
    """Return a cloud of some of the points."""
    return dataclasses.replace(
        cloud,
        positions=cloud.positions[kept],
        normals=cloud.normals[kept],
        colours=cloud.colours[kept],
        two_sided=cloud.two_sided[kept],
        radii=None if cloud.radii is None else cloud.radii[kept],
    )


def without_far_points(cloud: Cloud) -> tuple[Cloud, int]:
    """Return a cloud without its points far from the rest, and their number."""
    far = far_points(cloud.positions)
    number = int(np.count_nonzero(far))
    return (select(cloud, ~far), number) if number else (cloud, 0)
