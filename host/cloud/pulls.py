"""The pulls of a point's neighbours in its tangent plane; see :mod:`splatline.host.cloud.closing`.

A neighbour at q, seen from the point, has the pull u = 2 q / |q|^2.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

__all__ = ["NEAREST", "pull_neighbours", "weaken_other_side"]

STEEP = 2.0
"""Square of a neighbour's distance within the plane, over that of its height, below which it lies
off the surface: noise, or another layer."""

OFF = 1.7
"""Such a neighbour counts as this many times as far away, and so does one of another layer. It
cannot be relied on to close a gap when it is seen aslant; left out altogether, noise would make
discs as large as itself."""

NEAREST = 1e-12
"""Square of a distance, in cells, up to which a neighbour is the point itself."""


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


@nb.njit(error_model="numpy")
def weaken_other_side(facing: Any, count: int, normal: Any, pull: Any) -> None:
    """Weaken the pull of neighbours whose surface faces the other way: they are of another layer.

    Parameters
    ----------
    facing, count
        Normals of the neighbours, and how many there are: shape (3, most), float32.
    normal
        The point's: three float32.
    pull
        Changed; see :func:`pull_neighbours`.
    """
    nx, ny, nz = normal
    zero, one, weaker = np.float32(0.0), np.float32(1.0), np.float32(1.0 / OFF)
    for c in range(count):
        turned = nx * facing[0, c] + ny * facing[1, c] + nz * facing[2, c]
        strength = weaker if turned < zero else one
        pull[0, c] *= strength
        pull[1, c] *= strength
