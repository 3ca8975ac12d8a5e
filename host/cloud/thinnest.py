"""The direction in which a set of points is thinnest: an eigenvector in closed form."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

__all__ = ["thinnest"]

LINE = 1e-20
"""Square of the area of a plane's sides, over the fourth power of its size, that is rounding."""


@nb.njit(error_model="numpy")
def thinnest(moments: Any, vector: Any) -> tuple[float, float, float]:
    """Set the unit eigenvector of a covariance's least eigenvalue; return the eigenvalues.

    The eigenvalues are the roots of a cubic (Smith, "Eigenvalues of a symmetric 3 x 3 matrix",
    CACM 4 (1961)). The vector is across the rows of the matrix less the eigenvalue, of which the
    two that span the largest area are taken. If all lie on a line, it is some vector across that.

    Parameters
    ----------
    moments
        xx, xy, xz, yy, yz, zz.
    vector
        Set: shape (3,).

    Returns
    -------
    least, middle, most
        The eigenvalues.
    """
    size = moments[0] + moments[3] + moments[5]
    if not size > 0.0:
        vector[0], vector[1], vector[2] = 0.0, 0.0, 1.0
        return 0.0, 0.0, 0.0
    xx, xy, xz = moments[0] / size, moments[1] / size, moments[2] / size
    yy, yz, zz = moments[3] / size, moments[4] / size, moments[5] / size
    mean = (xx + yy + zz) / 3.0
    a, b, c = xx - mean, yy - mean, zz - mean
    spread = math.sqrt((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0)
    determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    cosine = 0.5 * determinant / (spread * spread * spread) if spread > 0.0 else 1.0
    angle = math.acos(min(max(cosine, -1.0), 1.0)) / 3.0
    most = mean + 2.0 * spread * math.cos(angle)
    least = mean + 2.0 * spread * math.cos(angle + 2.0 * math.pi / 3.0)
    middle = 3.0 * mean - most - least

    a, b, c = xx - least, yy - least, zz - least
    best = 0.0
    for pair in range(3):
        if pair == 0:
            x, y, z = xy * yz - xz * b, xz * xy - a * yz, a * b - xy * xy
        elif pair == 1:
            x, y, z = xy * c - xz * yz, xz * xz - a * c, a * yz - xy * xz
        else:
            x, y, z = b * c - yz * yz, yz * xz - xy * c, xy * yz - b * xz
        square = x * x + y * y + z * z
        if square > best:
            best = square
            vector[0], vector[1], vector[2] = x, y, z
    if best > LINE:
        length = math.sqrt(best)
        vector[0], vector[1], vector[2] = vector[0] / length, vector[1] / length, vector[2] / length
    else:
        _across(xx, xy, xz, yy, yz, zz, vector)
    return least * size, middle * size, most * size


@nb.njit(error_model="numpy")
def _across(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float, vector: Any) -> None:
    """Set a unit vector across the line on which the points lie."""
    # The row of the longest extent is along the line.
    x, y, z = xx, xy, xz
    if yy >= xx and yy >= zz:
        x, y, z = xy, yy, yz
    elif zz >= xx:
        x, y, z = xz, yz, zz
    if abs(x) <= abs(y) and abs(x) <= abs(z):
        a, b, c = 0.0, z, -y
    elif abs(y) <= abs(z):
        a, b, c = -z, 0.0, x
    else:
        a, b, c = y, -x, 0.0
    length = math.sqrt(a * a + b * b + c * c)
    vector[0], vector[1], vector[2] = a / length, b / length, c / length
