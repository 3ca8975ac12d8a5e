"""Groups of an index's points: a test that leaves out a whole group which covers no pixel's centre.

A cloud that is seen from afar has many points a pixel, but few of their discs hold the pixel's
centre. A block is then as large as a pixel, so its groups are tested before their points.
"""

from __future__ import annotations

import math
from typing import Any

import numba as nb
import numpy as np

__all__ = [
    "GROUP_BITS",
    "GROUP_BYTES",
    "GROUP_POINTS",
    "bound_group",
    "groups_are_small",
    "seen_groups",
]

GROUP_BITS = 3

GROUP_POINTS = 1 << GROUP_BITS
"""Points of a group: two vectors of four float32 or one of eight."""

GROUP_BYTES = 7 * 4 * GROUP_POINTS
"""Bytes of a group's discs in an index."""

WIDEST = 0.49
"""Radius in pixels below which a disc covers at most the centre that is nearest to its own."""

SLACK, ROUNDED = 1.00001, 1e-6
"""Factor on a group's radius, and addend in the block's radii, that cover rounding to float32."""

# In the type of what is written, so that the loop is made of vectors.
_ZERO, _ONE = np.uint8(0), np.uint8(1)


@nb.njit(error_model="numpy")
def bound_group(discs: Any, count: int, bound: Any, group: Any) -> None:
    """Set the sphere about the discs of a group.

    Parameters
    ----------
    discs
        The group's discs; see ``Index``.
    count
        How many there are.
    bound
        Bounds of its block.
    group
        Set: the middle relative to the block's and the radius, in radii of the block; shape (4,).
        The radius is infinite if a point is thin, as that is drawn even without a centre.
    """
    for axis in range(3):
        low = high = discs[axis, 0]
        for i in range(1, count):
            low, high = min(low, discs[axis, i]), max(high, discs[axis, i])
        group[axis] = np.float32(0.5) * (low + high)
    unit = bound.largest / bound.reach
    most = 0.0
    for i in range(count):
        x, y, z = discs[0, i] - group[0], discs[1, i] - group[1], discs[2, i] - group[2]
        most = max(most, math.sqrt(x * x + y * y + z * z) + unit * abs(discs[3, i]))
    group[3] = SLACK * most + ROUNDED if bound.reach > 0.0 else np.inf


@nb.njit(inline="always")
def groups_are_small(bound: Any, middle: Any, camera: Any) -> bool:
    """Return whether each disc of a block is too small to cover another centre than the nearest.

    Parameters
    ----------
    bound
        The block's bounds.
    middle
        The middle of its sphere in camera coordinates.
    camera
        The view.
    """
    least = middle[2] - bound.reach
    return bound.largest * camera.focal * _slant(bound, middle) < WIDEST * least


@nb.njit(inline="always")
def _slant(bound: Any, middle: Any) -> float:
    """Return by how much longer a length may be on the image, as the eye sees a block aslant.

    An offset d at the depth z moves an image by at most sqrt(1 + a^2 + b^2) |d| / z, for the slants
    a and b of where it starts.
    """
    x, y, z = middle
    furthest = (math.sqrt(x * x + y * y) + 2.0 * bound.reach) / (z - bound.reach)
    return math.sqrt(1.0 + furthest * furthest)


@nb.njit(error_model="numpy", fastmath={"contract", "nsz", "arcp"})
def seen_groups(
    bound: Any,
    groups: Any,
    count: int,
    rows: Any,
    middle: Any,
    camera: Any,
    margin: float,
    seen: Any,
) -> int:
    """Set whether each group of a block may cover a pixel's centre; return how many may.

    It is for a block whose :func:`groups_are_small` and that is far from the eye.

    Parameters
    ----------
    bound
        The block's bounds.
    groups
        Its groups: shape (4, most); see ``bound_group``.
    count
        How many there are.
    rows
        The directions right, down and ahead, each as three float32.
    middle
        The middle of the block's sphere in camera coordinates.
    camera
        The view.
    margin
        Error of a position in pixels.
    seen
        Set: shape (most,), uint8.
    """
    x, y, z = middle
    right, down, ahead = rows
    half, one = np.float32(0.5), np.float32(1.0)
    size = np.float32(bound.reach / z)
    across, below = np.float32(x / z), np.float32(y / z)
    focal = np.float32(camera.focal)
    middle_x, middle_y = np.float32(camera.middle_x), np.float32(camera.middle_y)
    # A group's nearest point is as near as its block's.
    span = np.float32(bound.reach * camera.focal * _slant(bound, middle) / (z - bound.reach))
    error = np.float32(margin)
    for i in range(count):
        dx, dy, dz = size * groups[0, i], size * groups[1, i], size * groups[2, i]
        nearer = one / (one + (ahead[0] * dx + ahead[1] * dy + ahead[2] * dz))
        a = (across + (right[0] * dx + right[1] * dy + right[2] * dz)) * nearer
        b = (below + (down[0] * dx + down[1] * dy + down[2] * dz)) * nearer
        column, line = middle_x + focal * a, middle_y + focal * b
        u, v = np.floor(column) + half - column, np.floor(line) + half - line
        reach = span * groups[3, i] + error
        # Seen too if the radius is not a number: infinite, in a block without size.
        seen[i] = _ZERO if u * u + v * v > reach * reach else _ONE
    may = 0
    for i in range(count):
        may += seen[i]
    return may
