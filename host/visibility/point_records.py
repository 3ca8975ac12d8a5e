"""Records of an index's points: all that the exact tests and the shading of a point read.

A view shows points that lie scattered over a large index. What is read of one lies together, so
that it takes one or two lines of the cache.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.cloud.prefetch import prefetch

__all__ = [
    "MATERIAL",
    "NORMAL",
    "POINT",
    "RADIUS",
    "THIN",
    "TWO_SIDED",
    "prefetch_point",
    "views",
]

POINT = np.dtype(
    [
        ("position", np.float64, 3),  # the cloud's own
        ("radius", np.float64),  # of the disc, in the cloud's unit
        ("normal", np.float32, 3),
        ("material", np.uint8),  # its colour in the palette
        ("two_sided", np.bool_),
        ("thin", np.bool_),
        ("", np.uint8),
    ]
)
"""A point: 48 bytes."""

RADIUS = 3
"""Number of the radius among a point's six float64; the position is 0 to 2."""

NORMAL = 8
"""Number of the normal's first coordinate among a point's twelve float32."""

MATERIAL, TWO_SIDED, THIN = 44, 45, 46
"""Numbers of the last fields among a point's bytes."""

POINT_BYTES = POINT.itemsize


def views(
    points: npt.NDArray[Any],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
    """Return points as float64 (n, 6), float32 (n, 12) and uint8 (n, 48), for compiled code.

    Each use of a structured row would count references (decision 0018).
    """
    count = len(points)
    return (
        points.view(np.float64).reshape(count, POINT_BYTES // 8),
        points.view(np.float32).reshape(count, POINT_BYTES // 4),
        points.view(np.uint8).reshape(count, POINT_BYTES),
    )


@nb.njit(inline="always")
def prefetch_point(doubles: Any, point: int) -> None:
    """Ask for the memory of a point; ``doubles`` are the points as float64."""
    prefetch(doubles, POINT_BYTES * point)
    prefetch(doubles, POINT_BYTES * point + POINT_BYTES - 1)
