"""Exact footprints: fractions at a splat's true place, size and slant, each with its own depth.

A disc's image is, to first order in its size, the ellipse ``A u^2 + 2 B u v + C v^2 <= 1`` about
its centre, u and v in pixels. Each line is cut where the ellipse crosses its pixels' centres, and
four lines by eight columns make a fraction.
"""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from ..rtl.format import BLOCK, ROWS
from .emit import LARGEST, ONE_PIXEL, emit

__all__ = ["conic", "encode_exact", "extent", "quantised_depth"]


@nb.njit
def conic(
    a: float, b: float, slope_x: float, slope_y: float, radius: float
) -> tuple[float, float, float, float]:
    """Return A, B, C and the determinant A C - B^2 of a disc's image.

    The point of the disc at the image offset (s, t), in units of the centre's depth over the focal
    length, lies at d = (s + a d_z, t + b d_z, d_z) from the disc's centre, with
    d_z = -(n'x s + n'y t) and a, b the centre's x / z and y / z. |d| <= R is a quadratic form in s
    and t. (The paper leaves a and b out: they are small near the middle of the image.)

    For a disc seen edge on A C and B^2 agree to many digits. The determinant is computed as the sum
    of the squares of its minors instead, which loses none.

    Parameters
    ----------
    a, b
        Where the centre lies: camera coordinates x / z and y / z.
    slope_x, slope_y
        n'x and n'y.
    radius
        Of the disc seen face on, in pixels, above 0.
    """
    x_x, x_y = 1.0 - a * slope_x, -a * slope_y
    y_x, y_y = -b * slope_x, 1.0 - b * slope_y
    scale = 1.0 / (radius * radius)
    minor_xy = x_x * y_y - x_y * y_x
    minor_xz = x_x * slope_y - x_y * slope_x
    minor_yz = y_x * slope_y - y_y * slope_x
    minors = minor_xy * minor_xy + minor_xz * minor_xz + minor_yz * minor_yz
    return (
        (x_x * x_x + y_x * y_x + slope_x * slope_x) * scale,
        (x_x * x_y + y_x * y_y + slope_x * slope_y) * scale,
        (x_y * x_y + y_y * y_y + slope_y * slope_y) * scale,
        minors * scale * scale,
    )


@nb.njit
def extent(centre: float, across: float, determinant: float) -> tuple[int, int]:
    """Return the first and last line (or column) whose pixels' centres an ellipse may cover.

    Parameters
    ----------
    centre
        Of the ellipse, in pixels.
    across
        The conic's coefficient of the other coordinate squared.
    determinant
        Of the conic, A C - B^2.
    """
    reach = min(math.sqrt(across / determinant), LARGEST)
    return math.ceil(centre - reach - 0.5), math.floor(centre + reach - 0.5)


@nb.njit
def quantised_depth(depth: float, largest: int) -> int:
    """Return the code of a depth given as a share of the frame's range."""
    return int(min(max(depth, 0.0), 1.0) * largest + 0.5)


@nb.njit
def encode_exact(
    column: float,
    line: float,
    form: Any,
    depth: float,
    gradient: Any,
    common: int,
    z_lsb: int,
    largest: int,
    at: int,
    to: Any,
) -> int:
    """Write a splat's fractions; see :mod:`splatline.host.emit` for ``at`` and ``to``.

    A splat that covers no pixel's centre draws the pixel that holds its own.

    Parameters
    ----------
    column, line
        Centre on the image.
    form
        A, B, C and determinant of its conic.
    depth
        Of the centre, as a share of the frame's depth range.
    gradient
        Change of that share from a pixel to the next on the right and below: shape (2,).
    common
        The words' bits that do not depend on the place.
    z_lsb, largest
        Where Z lies, and its largest value that draws.
    """
    _, _, width, height, _, _ = to
    a, b, _, determinant = form
    top, bottom = extent(line, a, determinant)
    top, bottom = max(top, 0), min(bottom, height - 1)
    before = at
    for begin_line in range(top, bottom + 1, ROWS):
        left, right = width, -1
        for row in range(ROWS):
            first, last = _covered(begin_line + row, column, line, a, b, determinant)
            if first <= last and begin_line + row <= bottom:
                left, right = min(left, first), max(right, last)
        for begin in range(max(left, 0), min(right, width - 1) + 1, BLOCK):
            scans = 0
            for row in range(ROWS):
                first, last = _covered(begin_line + row, column, line, a, b, determinant)
                first, last = max(first - begin, 0), min(last - begin, BLOCK - 1)
                filled = first <= last and begin_line + row <= bottom
                scans |= ((first | last << 3) if filled else 1) << 6 * row
            du, dv = _middle(scans)
            plane = (
                depth + gradient[0] * (begin + du - column) + gradient[1] * (begin_line + dv - line)
            )
            z = quantised_depth(plane, largest)
            at = emit(scans, begin, begin_line, common | z << z_lsb, at, to)
    if at == before:
        z = quantised_depth(depth, largest)
        return emit(ONE_PIXEL, math.floor(column), math.floor(line), common | z << z_lsb, at, to)
    return at


@nb.njit
def _covered(
    line: int, column: float, centre_line: float, a: float, b: float, determinant: float
) -> tuple[int, int]:
    """Return the first and last pixel of a line whose centres the ellipse covers."""
    dv = line + 0.5 - centre_line
    discriminant = a - determinant * dv * dv  # B^2 dv^2 - A (C dv^2 - 1)
    if discriminant < 0.0:
        return 0, -1
    root = math.sqrt(discriminant)
    left = max(column + (-b * dv - root) / a, -LARGEST)
    right = min(column + (-b * dv + root) / a, LARGEST)
    return math.ceil(left - 0.5), math.floor(right - 0.5)


@nb.njit
def _middle(scans: int) -> tuple[float, float]:
    """Return the mean place of a fraction's pixels, from its upper left corner."""
    count, across, down = 0, 0.0, 0.0
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        if first <= last:
            pixels = last - first + 1
            count += pixels
            across += pixels * 0.5 * (first + last + 1)
            down += pixels * (row + 0.5)
    return (across / count, down / count) if count else (0.5, 0.5)
