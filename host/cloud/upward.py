"""The upper side of ground and roofs: which estimated normals have a sign."""

from __future__ import annotations

import math
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

from .bulk import bounds
from .cloud import Cloud

__all__ = ["turn_upward", "upward_of"]

COLUMN_POINTS = 16
"""Points of a column, if they covered the cloud's bounding box evenly."""

THICKEST = 1.0
"""Most thickness of a single layer, in widths of a column: its points' heights above the plane
through their middle. A wall, a tree or two storeys are thicker."""

STEEPEST = 0.1
"""Least height of a unit normal that has an upper side."""

_Floats = npt.NDArray[np.float64]


def upward_of(orbit: tuple[float, float], up: str) -> str | None:
    """Return the axis up if an eye on an orbit looks down or is level; else None.

    Parameters
    ----------
    orbit
        Azimuth and elevation of the eye in degrees.
    up
        The axis that points up: x, y, z, or one of these with a minus.
    """
    return up if math.sin(math.radians(orbit[1])) >= 0.0 else None


def turn_upward(cloud: Cloud, up: str | None) -> Cloud:
    """Return a survey whose estimated normals point up where it has one layer.

    What is scanned from above is a height field nearly everywhere: its upper side is the outer one.
    A column of the cloud has one layer if all its points lie close to one plane, which is not
    steep. There the normals are turned up, and are one-sided from then on, so that the far slope of
    a ridge is not drawn as its back. All other points stay as they are.

    Parameters
    ----------
    cloud
        The cloud. It is returned as it is if it is no survey. Points that are not ``two_sided``
        keep their normals.
    up
        See :func:`upward_of`. None: the ground is seen from below, and shows its back; the cloud is
        returned as it is.
    """
    if up is None or not cloud.survey or not cloud.two_sided.any():
        return cloud
    axis, sign = "xyz".index(up[-1]), -1.0 if up.startswith("-") else 1.0
    across = [k for k in range(3) if k != axis]
    low, high = bounds(cloud.positions)
    spans = (high - low)[across]
    width = math.sqrt(COLUMN_POINTS * float(spans.prod()) / len(cloud))
    # Of a cloud that is nearly a line, columns are its parts.
    width = max(width, COLUMN_POINTS * float(spans.max()) / len(cloud))
    scale = 1.0 / width if width > 0.0 else math.inf
    if not math.isfinite(width * scale):  # a single position, or lengths beyond all scans
        return cloud
    sides = [int(span * scale) + 1 for span in spans]
    columns = np.zeros((sides[0] * sides[1], 9))
    columns[:, 7], columns[:, 8] = np.inf, -np.inf
    normals, two_sided = cloud.normals.copy(), cloud.two_sided.copy()
    frame = np.array([*across, axis]), low, scale, sides[1], sign
    _add_points(cloud.positions, normals, *frame, columns)
    _measure_thickness(cloud.positions, *frame, columns)
    _turn(cloud.positions, *frame, columns, THICKEST * width, normals, two_sided)
    return cloud.turned(normals, two_sided)


@nb.njit(inline="always")
def _column_of(positions: Any, i: int, order: Any, low: Any, scale: float, side: int) -> int:
    """Return the column of a point."""
    first = int((positions[i, order[0]] - low[order[0]]) * scale)
    return first * side + int((positions[i, order[1]] - low[order[1]]) * scale)


@cached_njit()
def _add_points(
    positions: Any,
    normals: Any,
    order: Any,
    low: Any,
    scale: float,
    side: int,
    sign: float,
    columns: Any,
) -> None:
    """Add up each column's points, positions and upward normals; the axis up is the last."""
    for i in range(len(positions)):
        column = columns[_column_of(positions, i, order, low, scale, side)]
        turn = 1.0 if normals[i, order[2]] * sign >= 0.0 else -1.0
        column[0] += 1.0
        for k in range(3):
            column[1 + k] += positions[i, order[k]]
            column[4 + k] += turn * normals[i, order[k]]


@cached_njit()
def _measure_thickness(
    positions: Any, order: Any, low: Any, scale: float, side: int, sign: float, columns: Any
) -> None:
    """Set each column's plane, and the range of heights above it."""
    for j in range(len(columns)):
        column = columns[j]
        if column[0] > 0.0:
            length = math.sqrt(column[4] ** 2 + column[5] ** 2 + column[6] ** 2)
            for k in range(3):
                column[1 + k] /= column[0]
                column[4 + k] /= length if length > 0.0 else 1.0
    for i in range(len(positions)):
        column = columns[_column_of(positions, i, order, low, scale, side)]
        height = 0.0
        for k in range(3):
            height += (positions[i, order[k]] - column[1 + k]) * column[4 + k]
        column[7], column[8] = min(column[7], height), max(column[8], height)


@cached_njit(parallel=True)
def _turn(
    positions: Any,
    order: Any,
    low: Any,
    scale: float,
    side: int,
    sign: float,
    columns: Any,
    thickest: float,
    normals: Any,
    two_sided: Any,
) -> None:
    """Turn the normals up, and make them one-sided, where a column has one layer."""
    for i in nb.prange(len(positions)):
        column = columns[_column_of(positions, i, order, low, scale, side)]
        height = normals[i, order[2]] * sign
        single = column[8] - column[7] <= thickest and column[6] * sign >= STEEPEST
        if two_sided[i] and single and abs(height) >= STEEPEST:
            two_sided[i] = False
            if height < 0.0:
                for k in range(3):
                    normals[i, k] = -normals[i, k]
