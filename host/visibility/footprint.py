"""A disc's footprint: the ellipse that it covers on the image, to first order in its size."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

__all__ = ["FLAT", "SMALLEST", "conic", "covers_own_pixel", "is_tiny"]

FLAT = 0.02
"""Pixels of r^2 over the focal length up to which a disc is drawn to first order. Its true ellipse
lies within half of that."""

SMALLEST = 1e-3
"""Least radius in pixels that is computed with, so that the conic stays finite."""


@nb.njit(inline="always")
def conic(a: float, b: float, slope_x: float, slope_y: float) -> tuple[float, float, float, float]:
    """Return A, B, C and the determinant A C - B^2 of a disc's image, for a radius of 1.

    The point of the disc at the image offset (s, t), in units of the centre's depth over the focal
    length, lies at d = (s + a d_z, t + b d_z, d_z) from the disc's centre, with
    d_z = -(n'x s + n'y t) and a, b the centre's x / z and y / z. |d|^2 is a quadratic form in s
    and t. (The paper leaves a and b out: they are small near the middle of the image.)

    For a disc seen edge on, A C and B^2 agree to many digits. The determinant is therefore computed
    as the sum of the squares of its minors, which loses no digits.

    Parameters
    ----------
    a, b
        The centre's x / z and y / z in camera coordinates.
    slope_x, slope_y
        n'x and n'y.
    """
    x_x, x_y = 1.0 - a * slope_x, -a * slope_y
    y_x, y_y = -b * slope_x, 1.0 - b * slope_y
    minor_xy = x_x * y_y - x_y * y_x
    minor_xz = x_x * slope_y - x_y * slope_x
    minor_yz = y_x * slope_y - y_y * slope_x
    return (
        x_x * x_x + y_x * y_x + slope_x * slope_x,
        x_x * x_y + y_x * y_y + slope_x * slope_y,
        x_y * x_y + y_y * y_y + slope_y * slope_y,
        minor_xy * minor_xy + minor_xz * minor_xz + minor_yz * minor_yz,
    )


@nb.njit(inline="always")
def is_tiny(radius: float, a: float, b: float, inverse_focal: float) -> bool:
    """Return whether a disc can cover no other pixel's centre than that of the pixel it lies in.

    Parameters
    ----------
    radius
        In pixels.
    a, b
        x / z and y / z of its centre. Seen at that slant, it reaches up to sqrt(1 + a^2 + b^2)
        times its radius.
    inverse_focal
        1 over the focal length, in pixels.
    """
    reach = radius * (1.0 + 0.5 * (a * a + b * b))
    return reach < 0.5 and radius * radius * inverse_focal <= FLAT


@nb.njit(inline="always")
def covers_own_pixel(column: float, line: float, square: float, form: Any) -> bool:
    """Return whether an ellipse covers the centre of the pixel that holds its centre."""
    dx, dy = math.floor(column) + 0.5 - column, math.floor(line) + 0.5 - line
    return form[0] * dx * dx + 2.0 * form[1] * dx * dy + form[2] * dy * dy <= square
