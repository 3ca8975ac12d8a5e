"""A quick test of points, several at once: most points of a dense cloud are not seen.

It takes vector instructions and float32. It leaves out no point that the exact tests of
``project_loop`` would draw, as its margins cover the rounding. Where it says nothing, they decide.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from .skips import REASONS

__all__ = ["MARGIN", "NEARBY", "VECTORS", "along", "test_points"]

NEARBY = 2.0
"""Least distance of a block along the view, in its own radii: nearer ones are not tested, as
differences of float32 lose too many digits."""

MARGIN = 2.0**-20
"""Error in pixels of a position on the image, for each pixel of the image's size: 16 roundings."""

TURNED = 1e-5
"""Least n . (a, b, 1) of a surface that shows its back for certain."""

SLACK = 1.001
"""Factor on a disc's radius that covers the rounding of its conic."""

VECTORS = 32
"""Points that are computed at once: a rest would be computed one by one."""

# In the type of what is written, so that the loop is made of vectors.
_NO_PIXEL, _FACING_AWAY = np.uint8(REASONS["no_pixel"]), np.uint8(REASONS["facing_away"])
_KEPT = np.uint8(0)


@nb.njit(inline="always")
def along(row: Any, x: float, y: float, z: float) -> float:
    """Return a vector's coordinate along a direction."""
    return row[0] * x + row[1] * y + row[2] * z


@nb.njit(error_model="numpy", fastmath={"contract", "nsz", "arcp"})
def test_points(
    discs: Any,
    count: int,
    axes: Any,
    centre: Any,
    image: Any,
    radius: float,
    margin: float,
    faces: bool,
    found: Any,
) -> None:
    """Set the reason to leave each point out, or 0, as far as the test knows.

    A disc whose conic is Q covers a centre at the offset d if Q(d) <= r^2. sqrt(Q) is a norm, so an
    error e of d changes it by at most sqrt(Q(e)), which is at most |e| sqrt(A + C).

    Parameters
    ----------
    discs
        Shape (7, most); see ``Index``. All values are float32, here in units of the block's
        distance along the view.
    count
        How many there are; a multiple of ``VECTORS`` is quickest.
    axes
        The directions right, down and ahead.
    centre
        The middle of the block's sphere over its distance, right and down, and its radius.
    image
        The focal length, and the column and line of the view's axis.
    radius
        Of the block's largest disc, in pixels.
    margin
        Error of a position in pixels.
    faces
        Whether points are left out that face away.
    found
        Set: shape (most,), uint8.
    """
    right, down, ahead = axes
    turned = np.float32(TURNED if faces else np.inf)
    half, one, two, slack = np.float32(0.5), np.float32(1.0), np.float32(2.0), np.float32(SLACK)
    for i in range(count):
        dx, dy, dz = centre[2] * discs[0, i], centre[2] * discs[1, i], centre[2] * discs[2, i]
        nearer = one / (one + along(ahead, dx, dy, dz))
        a = (centre[0] + along(right, dx, dy, dz)) * nearer
        b = (centre[1] + along(down, dx, dy, dz)) * nearer
        column, line = image[1] + image[0] * a, image[2] + image[0] * b
        u, v = np.floor(column) + half - column, np.floor(line) + half - line
        share = discs[3, i]
        pixels = radius * np.abs(share) * nearer
        nx = along(right, discs[4, i], discs[5, i], discs[6, i])
        ny = along(down, discs[4, i], discs[5, i], discs[6, i])
        facing = nx * a + ny * b + along(ahead, discs[4, i], discs[5, i], discs[6, i])
        # As in ``footprint.conic``, but for a factor of the square of ``facing``.
        sx, sy = nx, ny
        x_x, x_y = facing - a * sx, -a * sy
        y_x, y_y = -b * sx, facing - b * sy
        form_a = x_x * x_x + y_x * y_x + sx * sx
        form_b = x_x * x_y + y_x * y_y + sx * sy
        form_c = x_y * x_y + y_y * y_y + sy * sy
        square = form_a * u * u + two * form_b * u * v + form_c * v * v
        reach = (pixels * np.abs(facing) + margin * np.sqrt(form_a + form_c)) * slack
        missed = (pixels < half) & (square > reach * reach)
        away = (facing > turned) & (np.copysign(one, share) > np.float32(0.0))
        found[i] = _NO_PIXEL if missed else (_FACING_AWAY if away else _KEPT)
