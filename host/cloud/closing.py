"""The closing radius of a point: how far its disc must reach to close the gaps about it.

In the tangent plane, with the point at the origin, a neighbour q takes what lies beyond the line
x . u = 1 with u = 2 q / |q|^2: its *pull*. The point's Voronoi region is where no pull exceeds 1.
So in the direction w the region ends at 1 over the largest u . w, and the corner of two neighbours
lies at |u - u'| / (u x u') from the point.

A corner is the middle of a gap only if the triangle of the three points has no obtuse angle. Else
the gap goes on beyond the triangle, and either has its middle further on, which other points reach,
or is the open side of a border, which stays open.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba.extending import intrinsic

__all__ = [
    "APART",
    "COSINES",
    "DIRECTIONS",
    "SINES",
    "Closing",
    "closing_radius",
    "pull_neighbours",
    "strongest",
]

DIRECTIONS = 16
"""Directions in which the nearest side of the Voronoi region is found."""

_ANGLES = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
COSINES = np.cos(_ANGLES).astype(np.float32)
SINES = np.sin(_ANGLES).astype(np.float32)

STEEP = 2.0
"""Square of a neighbour's distance within the plane, over that of its height, below which it lies
off the surface: noise, or another layer."""

OFF = 1.7
"""Such a neighbour counts as this many times as far away. It cannot be relied on to close a gap
when it is seen aslant; left out altogether, noise would make discs as large as itself."""

OBTUSE = 0.3
"""Minus the cosine of the largest angle of a triangle that is not obtuse. Above 0, as a square
grid has right angles."""

LEAST = math.sqrt(0.5)
"""Least closing radius for a nearest neighbour at the distance 1: that of a square grid."""

APART = 0.3
"""The same where each point is shown apart from the others."""

NEAREST = 1e-12
"""Square of a distance, in cells, up to which a neighbour is the point itself."""

INDEX_BITS = 11
"""Low bits of a float32 that hold a neighbour's number."""


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
def pull_neighbours(away: Any, count: int, position: Any, normal: Any, pull: Any) -> None:
    """Set the pull of each neighbour in a point's tangent plane.

    Parameters
    ----------
    away
        Positions of the neighbours, the point among them: shape (3, most), float32.
    count
        How many there are.
    position, normal
        The point's: three float32 each.
    pull
        Set: shape (2, most), float32.
    """
    x, y, z = position
    nx, ny, nz = normal
    # Axes of the plane: Duff et al., "Building an orthonormal basis, revisited", JCGT 6 (2017).
    one, two = np.float32(1.0), np.float32(2.0)
    off, steep, nearest = np.float32(2.0 / OFF), np.float32(STEEP), np.float32(NEAREST)
    sign = one if nz >= 0.0 else -one
    a = -one / (sign + nz)
    b = nx * ny * a
    ux, uy, uz = one + sign * nx * nx * a, sign * b, -sign * nx
    vx, vy, vz = b, sign + ny * ny * a, -ny
    for c in range(count):
        dx, dy, dz = away[0, c] - x, away[1, c] - y, away[2, c] - z
        right = ux * dx + uy * dy + uz * dz
        up = vx * dx + vy * dy + vz * dz
        height = nx * dx + ny * dy + nz * dz
        square = right * right + up * up
        strength = (two if square > steep * height * height else off) / square
        strength = strength if square > nearest else np.float32(0.0)
        pull[0, c] = right * strength
        pull[1, c] = up * strength


@intrinsic
def _larger(_: Any, best: Any, value: Any, number: Any) -> Any:
    """Return the larger of ``best`` and a float32's bits with a number in the low ones.

    Positive floats are ordered as their bits are, so LLVM makes a vector maximum of this. It makes
    none of a float and an index that are chosen together.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(32)
        bits = builder.bitcast(arguments[1], whole)
        mask = ir.Constant(whole, -(1 << INDEX_BITS))
        tagged = builder.or_(builder.and_(bits, mask), builder.trunc(arguments[2], whole))
        is_larger = builder.icmp_signed(">", tagged, arguments[0])
        return builder.select(is_larger, tagged, arguments[0])

    return nb.int32(nb.int32, nb.float32, nb.int64), code


@intrinsic
def _as_float(_: Any, bits: Any) -> Any:
    """Return the float32 that has these bits."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.FloatType())

    return nb.float32(nb.int32), code


@intrinsic
def _number(_: Any, value: Any) -> Any:
    """Return the number in a float32's low bits."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(32)
        bits = builder.bitcast(arguments[0], whole)
        low = builder.and_(bits, ir.Constant(whole, (1 << INDEX_BITS) - 1))
        return builder.zext(low, ir.IntType(64))

    return nb.int64(nb.float32), code


@nb.njit(error_model="numpy")
def strongest(right: Any, up: Any, count: int, cosines: Any, sines: Any, most: Any) -> None:
    """Set the strongest pull in each direction, with its neighbour's number in the low bits.

    Parameters
    ----------
    right, up
        The pulls.
    count
        How many there are.
    cosines, sines
        ``COSINES`` and ``SINES``.
    most
        Set: shape (``DIRECTIONS``,), float32; tiny where no neighbour pulls that way.
    """
    for j in range(DIRECTIONS):
        cosine, sine = cosines[j], sines[j]
        best = np.int32(0)
        for c in range(count):
            best = _larger(best, right[c] * cosine + up[c] * sine, c)
        most[j] = _as_float(best)


@nb.njit(error_model="numpy")
def closing_radius(pull: Any, most: Any, sides: Any) -> tuple[float, bool]:
    """Return the distance of the furthest gap, and whether there is any gap.

    The distance is infinite if there is no neighbour. Without a gap it tells the nearest neighbour.

    With u = 2 q / |q|^2, the triangle of the point and two neighbours has the same angles as that
    of the origin, u and u', but those at u and u' are exchanged.

    Parameters
    ----------
    pull
        Of each neighbour: shape (2, most).
    most
        See :func:`strongest`.
    sides
        Overwritten: shape (2, ``DIRECTIONS`` + 1), float32.
    """
    zero = np.float32(0.0)
    for j in range(DIRECTIONS):
        one = _number(most[j])
        exists = most[j] > NEAREST
        sides[0, j + 1] = pull[0, one] if exists else zero
        sides[1, j + 1] = pull[1, one] if exists else zero
    sides[0, 0], sides[1, 0] = sides[0, DIRECTIONS], sides[1, DIRECTIONS]
    nearest, furthest = zero, zero
    obtuse = np.float32(OBTUSE * OBTUSE)
    for j in range(DIRECTIONS):  # choices instead of branches, so that LLVM makes vectors of it
        ax, ay, bx, by = sides[0, j], sides[1, j], sides[0, j + 1], sides[1, j + 1]
        cross = ax * by - ay * bx
        aa, bb, ab = ax * ax + ay * ay, bx * bx + by * by, ax * bx + ay * by
        across = aa + bb - ab - ab
        nearest = max(nearest, aa)
        is_middle = (
            ((ax != bx) | (ay != by))
            & (cross > zero)
            & ((ab >= zero) | (ab * ab <= obtuse * aa * bb))
            & ((bb >= ab) | ((bb - ab) * (bb - ab) <= obtuse * bb * across))
            & ((aa >= ab) | ((aa - ab) * (aa - ab) <= obtuse * aa * across))
        )
        gap = across / (cross * cross) if is_middle else zero
        furthest = max(furthest, gap)
    if not nearest > zero:
        return np.inf, False
    least = (2.0 * LEAST) ** 2 / float(nearest)
    return math.sqrt(max(float(furthest), least)), bool(furthest > zero)
