"""Extent of a cloud's points and discs, in camera axes: one pass over the cloud."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

__all__ = ["Reach", "measure_reach"]

CHUNKS = 64
"""Parts of the work."""

_Floats = npt.NDArray[np.float64]


class Reach(NamedTuple):
    """The extent that a view is fitted to.

    Parameters
    ----------
    least, most
        Of the points in camera axes: shape (3,).
    points, discs
        For each of the image's two axes the furthest reach beyond a plane through the origin, of
        points and of discs: (across - slope along), then (-across - slope along): shape (2, 2).
    nearest_disc
        Least distance along the view, less the disc's radius times ``depth_share``.
    touched
        For each of the image's two axes the points that reach furthest beyond the planes of the
        slopes ``touching``: each one's coordinates across and along the view: shape (2, 2, 2).
    """

    least: _Floats
    most: _Floats
    points: _Floats
    discs: _Floats
    nearest_disc: float
    touched: _Floats


def measure_reach(
    positions: _Floats,
    radii: _Floats | None,
    axes: _Floats,
    slopes: tuple[float, float],
    disc_slopes: tuple[float, float],
    depth_share: float,
    touching: tuple[float, float],
) -> Reach:
    """Return how far a cloud reaches.

    Parameters
    ----------
    positions
        Shape (n, 3), float64; n at least 1.
    radii
        Of the discs, which are taken as spheres: shape (n,). None: 0.
    axes
        Camera axes as rows: right, down and forward.
    slopes, disc_slopes
        Of the planes for points and discs: across over along, for each of the image's axes.
    depth_share
        See :class:`Reach`.
    touching
        Further slopes of planes for points: across over along, for each of the image's axes.
    """
    found = np.full((CHUNKS, 15), -np.inf)
    touched = np.full((CHUNKS, 4, 3), -np.inf)
    sizes = np.zeros(1) if radii is None else np.ascontiguousarray(radii, np.float64)
    stride = 0 if radii is None else 1
    _measure(
        np.ascontiguousarray(positions, np.float64), sizes, stride, axes, slopes, disc_slopes,
        depth_share, found, touching, touched,
    )  # fmt: skip
    most = found.max(axis=0)
    furthest = touched[touched[:, :, 0].argmax(axis=0), np.arange(4), 1:]
    return Reach(
        -most[:3], most[3:6], most[6:10].reshape(2, 2), most[10:14].reshape(2, 2), -float(most[14]),
        furthest.reshape(2, 2, 2),
    )  # fmt: skip


@cached_njit(parallel=True, error_model="numpy")
def _measure(
    positions: Any,
    radii: Any,
    stride: int,
    axes: Any,
    slopes: Any,
    disc_slopes: Any,
    depth_share: float,
    found: Any,
    touching: Any,
    touched: Any,
) -> None:
    """Set each chunk's largest values, in the order of :class:`Reach`; the least are negated.

    ``touched`` has how far a point lies beyond each plane, and its coordinates across and along.
    """
    count = len(positions)
    right, down = math.hypot(1.0, disc_slopes[0]), math.hypot(1.0, disc_slopes[1])
    for chunk in nb.prange(CHUNKS):
        most = np.full(15, -np.inf)
        touch = np.full((4, 3), -np.inf)
        for i in range(count * chunk // CHUNKS, count * (chunk + 1) // CHUNKS):
            x, y, z = positions[i, 0], positions[i, 1], positions[i, 2]
            a = axes[0, 0] * x + axes[0, 1] * y + axes[0, 2] * z
            b = axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z
            c = axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z
            radius = radii[stride * i]
            most[0], most[1], most[2] = max(most[0], -a), max(most[1], -b), max(most[2], -c)
            most[3], most[4], most[5] = max(most[3], a), max(most[4], b), max(most[5], c)
            most[6] = max(most[6], a - slopes[0] * c)
            most[7] = max(most[7], -a - slopes[0] * c)
            most[8] = max(most[8], b - slopes[1] * c)
            most[9] = max(most[9], -b - slopes[1] * c)
            inward = radius * right - disc_slopes[0] * c
            most[10], most[11] = max(most[10], a + inward), max(most[11], -a + inward)
            inward = radius * down - disc_slopes[1] * c
            most[12], most[13] = max(most[12], b + inward), max(most[13], -b + inward)
            most[14] = max(most[14], radius * depth_share - c)
            for plane in range(4):
                across = a if plane < 2 else b
                beyond = across if plane % 2 == 0 else -across
                beyond -= touching[plane // 2] * c
                if beyond > touch[plane, 0]:
                    touch[plane, 0], touch[plane, 1], touch[plane, 2] = beyond, across, c
        for value in range(15):
            found[chunk, value] = most[value]
        touched[chunk] = touch
