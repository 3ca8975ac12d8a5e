"""The closing radius of a point: how far its disc must reach to close the gaps about it.

In the tangent plane, with the point at the origin, a neighbour q takes what lies beyond the line
x . u = 1 with its pull u = 2 q / |q|^2 (``host/cloud/pulls.py``). The point's Voronoi region is
where no pull exceeds 1. So in the direction w the region ends at 1 over the largest u . w, and the
corner of two neighbours lies at |u - u'| / (u x u') from the point.

A corner is the middle of a gap if the triangle of the three points has no obtuse angle. Else it
lies beyond the triangle's longest side: within a gap of other points, or off the border of a
surface, which stays open. A neighbour beyond it tells which. Within a gap, the two points at the
ends of the longest side reach it from both of its sides. So the third, at the obtuse angle, need
not.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from .furthest_pull import furthest_pull

__all__ = [
    "APART",
    "MOST_SIDES",
    "Closing",
    "closing_radius",
]

AROUND = np.array([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]], np.float32)
"""Directions, after that to the right, in which the first sides of a Voronoi region are found."""

MOST_SIDES = 32
"""Most sides of a Voronoi region beside those."""

EDGE = 1e-4
"""Share of an edge's size by which a pull must reach beyond it."""

OBTUSE = 0.15
"""Minus the cosine of the largest angle of a triangle that is not obtuse. Above 0, as a square
grid has right angles, and as each point sees the others in its own plane."""

BEYOND = 2.0
"""Distance from a gap's middle, in the gap's radii, up to which a point lies about the gap."""

ACROSS = 0.3
"""Radii by which such a point lies beyond the middle, seen from the triangle."""

LEAST = math.sqrt(0.5)
"""Least closing radius for a nearest neighbour at the distance 1: that of a square grid."""

APART = 0.3
"""The same where each point is shown apart from the others."""


class Closing(NamedTuple):
    """Sizes of the gaps about a cloud's distinct points; see ``measure_cells``.

    Parameters
    ----------
    radii
        Closing radii in units of the bulk's extent: shape (m,), float64.
    thin
        Which points have no gap about them: shape (m,), bool.
    """

    radii: npt.NDArray[np.float64]
    thin: npt.NDArray[np.bool_]

    @classmethod
    def empty(cls, count: int) -> Closing:
        """Return room for the radii of some points."""
        return cls(np.empty(count), np.empty(count, np.bool_))


@nb.njit(error_model="numpy")
def closing_radius(pull: Any, count: int, waiting: Any) -> tuple[float, bool]:
    """Return the distance of the furthest gap, and whether there is any gap.

    The distance is infinite if there is no neighbour. Without a gap it tells the nearest neighbour.

    The sides of the Voronoi region are the corners of the convex hull of the pulls and the origin.
    They are found as by Quickhull (Barber et al., ACM TOMS 22, 1996): between two corners of the
    hull lies another if a pull reaches beyond the edge from one to the other.

    With u = 2 q / |q|^2, the triangle of the point and two neighbours has the same angles as that
    of the origin, u and u', but those at u and u' are exchanged.

    Parameters
    ----------
    pull, count
        Of each neighbour, and how many there are: shape (2, most), float32.
    waiting
        Overwritten: shape (``MOST_SIDES`` + 1,), int64.
    """
    right, up = pull[0], pull[1]
    zero, edge = np.float32(0.0), np.float32(EDGE)
    first = last = furthest_pull(right, up, count, np.float32(1.0), zero)
    nearest, furthest, widest, found = zero, zero, zero, 0
    one, other = first, first
    for turn in range(4):
        waiting[0] = first
        if turn < 3:
            waiting[0] = furthest_pull(right, up, count, AROUND[turn, 0], AROUND[turn, 1])
        left = 1
        while left:
            following = waiting[left - 1]
            ax, ay = (right[last], up[last]) if last >= 0 else (zero, zero)
            bx, by = (right[following], up[following]) if following >= 0 else (zero, zero)
            x, y = by - ay, ax - bx  # across the edge, to its outer side
            if following != last and found < MOST_SIDES:
                between = furthest_pull(right, up, count, x, y)
                cx, cy = (right[between], up[between]) if between >= 0 else (zero, zero)
                beyond = (cx - ax) * x + (cy - ay) * y
                size = (abs(ax) + abs(cx)) * abs(x) + (abs(ay) + abs(cy)) * abs(y)
                if beyond > edge * size:
                    waiting[left] = between
                    left, found = left + 1, found + 1
                    continue
            nearest = max(nearest, ax * ax + ay * ay)
            cross = ax * by - ay * bx
            gap = (x * x + y * y) / (cross * cross) if cross > zero else zero
            # Choices instead of branches, which could not be foretold.
            is_acute = _is_acute(ax, ay, bx, by)
            furthest = max(furthest, gap if is_acute else zero)
            # No obtuse angle at the point itself.
            is_open = (gap > widest) & (not is_acute) & (ax * bx + ay * by >= zero)
            widest = gap if is_open else widest
            one, other = last if is_open else one, following if is_open else other
            last = following
            left -= 1
    if not nearest > zero:
        return np.inf, False
    if widest > furthest and _is_surrounded(right, up, count, one, other):
        furthest = widest
    least = (2.0 * LEAST) ** 2 / float(nearest)
    return math.sqrt(max(float(furthest), least)), bool(furthest > zero)


@nb.njit(inline="always")
def _is_acute(ax: float, ay: float, bx: float, by: float) -> bool:
    """Return whether the triangle of a point and two neighbours has no obtuse angle."""
    zero, obtuse = np.float32(0.0), np.float32(OBTUSE * OBTUSE)
    aa, bb, ab = ax * ax + ay * ay, bx * bx + by * by, ax * bx + ay * by
    across = aa + bb - ab - ab
    return bool(
        ((ab >= zero) | (ab * ab <= obtuse * aa * bb))
        & ((bb >= ab) | ((bb - ab) * (bb - ab) <= obtuse * bb * across))
        & ((aa >= ab) | ((aa - ab) * (aa - ab) <= obtuse * aa * across))
    )


@nb.njit(error_model="numpy")
def _is_surrounded(right: Any, up: Any, count: int, one: int, other: int) -> bool:
    """Return whether a neighbour lies beyond the corner of two sides, hardly further away.

    With the corner at c, and h from c to the middle of the longest side of the triangle, that is a
    neighbour at q with |q - c| <= ``BEYOND`` |c| and (c - q) . h >= ``ACROSS`` |c| |h|. Both are
    computed times |u|^2, as q = 2 u / |u|^2.

    Parameters
    ----------
    right, up, count
        The pulls.
    one, other
        The sides' numbers.
    """
    ax, ay, bx, by = right[one], up[one], right[other], up[other]
    cross = ax * by - ay * bx
    cx, cy = (by - ay) / cross, (ax - bx) / cross
    two, four = np.float32(2.0), np.float32(4.0)
    aa, bb = ax * ax + ay * ay, bx * bx + by * by
    # The middle of the longest side of the triangle, seen from the corner.
    px, py, qx, qy = two * ax / aa, two * ay / aa, two * bx / bb, two * by / bb
    pp, qq, pq = px * px + py * py, qx * qx + qy * qy, (px - qx) ** 2 + (py - qy) ** 2
    if pq >= pp and pq >= qq:
        hx, hy = px + qx, py + qy
    elif pp >= qq:
        hx, hy = px, py
    else:
        hx, hy = qx, qy
    half = np.float32(0.5)
    hx, hy = half * hx - cx, half * hy - cy
    square = cx * cx + cy * cy
    near = np.float32(BEYOND * BEYOND - 1.0) * square
    least = np.float32(ACROSS) * np.float32(math.sqrt(square * (hx * hx + hy * hy)))
    middle = cx * hx + cy * hy - least
    zero, found = np.float32(0.0), np.int32(0)
    for c in range(count):
        x, y = right[c], up[c]
        uu = x * x + y * y
        is_near = near * uu + four * (x * cx + y * cy) - four
        is_across = middle * uu - two * (x * hx + y * hy)
        found |= np.int32((is_near >= zero) & (is_across >= zero))
    return bool(found > 0)
