"""Exact footprints: a splat's ellipse on the image, at its true position, size and slant.

A disc's image is, to first order in its size, the ellipse ``A u^2 + 2 B u v + C v^2 <= r^2`` about
its centre, u and v in pixels. ``in_perspective`` gives the true ellipse of a disc that needs it.
Each line is cut where the ellipse crosses its pixels' centres. Most splats fit four lines of eight
columns, one fraction; ``host.encode.large_splats`` encodes the others.
"""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS
from splatline.host.visibility.view import LARGEST

__all__ = [
    "CLOSED",
    "extent",
    "in_perspective",
    "one_fraction",
    "row_code",
    "span",
]

CLOSED = 0.99
"""Square of a disc's radius over its distance up to which its image is an ellipse."""


@nb.njit(error_model="numpy")
def in_perspective(
    form: Any, slope_x: float, slope_y: float, square: float, inverse_focal: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return a disc's image without approximation: an ellipse about another centre.

    The ray at the offset w = (s, t) from the centre's meets the disc's plane at the depth
    z / (1 + n'.w), so that the point lies within R of the disc's centre where
    Q(w) <= (R / z)^2 (1 + n'.w)^2, with Q the conic's form: again a quadratic in w. Its determinant
    is that of Q less (R / z)^2 |n'|^2, since Q is |n'|^2 across n'.

    A disc that reaches the eye's plane, R >= z, has no ellipse; see
    ``host.encode.large_splats``.

    Parameters
    ----------
    form
        A, B, C and determinant of the conic.
    slope_x, slope_y
        n'x and n'y.
    square
        Of the radius in pixels.
    inverse_focal
        1 over the focal length in pixels.

    Returns
    -------
    right, down
        From the disc's centre to the ellipse's, in pixels.
    square
        The ellipse's right side.
    a, b, c, determinant
        Its form.
    """
    share = square * inverse_focal * inverse_focal
    a = form[0] - share * slope_x * slope_x
    b = form[1] - share * slope_x * slope_y
    c = form[2] - share * slope_y * slope_y
    steep = slope_x * slope_x + slope_y * slope_y
    determinant = form[3] - share * steep
    if share >= CLOSED:
        return 0.0, 0.0, square, form[0], form[1], form[2], form[3]
    pull = square * inverse_focal
    right = pull * (c * slope_x - b * slope_y) / determinant
    down = pull * (a * slope_y - b * slope_x) / determinant
    right_side = square + pull * (slope_x * right + slope_y * down)
    return right, down, right_side, a, b, c, determinant


@nb.njit(inline="always")
def extent(centre: float, square: float) -> tuple[int, int]:
    """Return the first and last line (or column) whose pixels' centres an ellipse may cover.

    Parameters
    ----------
    centre
        Of the ellipse, in pixels.
    square
        Of its reach: of lines r^2 A / (A C - B^2), of columns r^2 C / (A C - B^2).
    """
    reach = math.sqrt(square)
    reach = reach if reach < LARGEST else LARGEST
    return math.ceil(centre - reach - 0.5), math.floor(centre + reach - 0.5)


@nb.njit(inline="always")
def span(
    most: float, used: float, middle: float, inverse: float, width: int
) -> tuple[int, int, bool]:
    """Return the first and last pixel of a row, and whether it has any.

    On the line dv below the centre the pixels' middle lies -B / A dv from the centre's column, and
    half their number is sqrt(A r^2 - (A C - B^2) dv^2) / A.

    Branch-free: whether a row is empty is unpredictable.

    Parameters
    ----------
    most, used
        A r^2 and (A C - B^2) dv^2.
    middle
        Of the row, less half a pixel.
    inverse
        1 / A.
    width
        Of the image: the span is clipped to it.
    """
    square = most - used
    half = math.sqrt(square if square > 0.0 else 0.0) * inverse
    low, high = middle - half, middle + half
    low = low if low > 0.0 else 0.0
    low = low if low < width else float(width)
    high = high if high < width - 1.0 else width - 1.0
    high = high if high > -1.0 else -1.0
    first, last = math.ceil(low), math.floor(high)
    return first, last, (square >= 0.0) & (first <= last)


@nb.njit(inline="always")
def row_code(first: int, last: int, filled: bool, begin: int) -> int:
    """Return a row of the fraction at column ``begin``, as SCANS has it."""
    return (first - begin | last - begin << 3) if filled else 1


@nb.njit(error_model="numpy")
def one_fraction(
    column: float, line: float, square: float, form: Any, width: int, height: int
) -> tuple[int, int, int, int]:
    """Return the fraction that holds all of a splat, if one does.

    The four rows are written out, which saves 25 ns: nearly every splat comes here.

    Parameters
    ----------
    column, line
        Centre on the image.
    square
        Of its radius, in pixels.
    form
        A, B, C and determinant of its conic.
    width, height
        Of the image.

    Returns
    -------
    found
        1; 0 if the splat covers no pixel's centre; 2 if it takes more fractions than one.
    x, top, scans
        First column, first line, and the rows.
    """
    a, b, _, determinant = form
    top, bottom = extent(line, a / determinant * square)
    top, bottom = max(top, 0), min(bottom, height - 1)
    if bottom >= top + ROWS:
        return 2, 0, 0, 0
    if top > bottom:
        return 0, 0, 0, 0
    inverse, most = 1.0 / a, a * square
    lean = -b * inverse
    dv = top + 0.5 - line
    middle = column + lean * dv - 0.5
    first_0, last_0, fills_0 = span(most, determinant * dv * dv, middle, inverse, width)
    dv, middle = dv + 1.0, middle + lean
    first_1, last_1, fills_1 = span(most, determinant * dv * dv, middle, inverse, width)
    dv, middle = dv + 1.0, middle + lean
    first_2, last_2, fills_2 = span(most, determinant * dv * dv, middle, inverse, width)
    dv, middle = dv + 1.0, middle + lean
    first_3, last_3, fills_3 = span(most, determinant * dv * dv, middle, inverse, width)
    # Rows below the image are empty.
    fills_1, fills_2 = fills_1 & (bottom > top), fills_2 & (bottom > top + 1)
    fills_3 = fills_3 & (bottom > top + 2)
    left = min(
        min(first_0 if fills_0 else width, first_1 if fills_1 else width),
        min(first_2 if fills_2 else width, first_3 if fills_3 else width),
    )
    right = max(
        max(last_0 if fills_0 else -1, last_1 if fills_1 else -1),
        max(last_2 if fills_2 else -1, last_3 if fills_3 else -1),
    )
    if right >= left + BLOCK:
        return 2, 0, 0, 0
    scans = (
        row_code(first_0, last_0, fills_0, left)
        | row_code(first_1, last_1, fills_1, left) << 6
        | row_code(first_2, last_2, fills_2, left) << 12
        | row_code(first_3, last_3, fills_3, left) << 18
    )
    return 1 if left <= right else 0, left, top, scans
