"""The shape table: the pixels of the ellipse of each quantised size and normal.

A pixel whose centre lies (dx, dy) from the ellipse's is inside where
``dx^2 + dy^2 + (n'x dx + n'y dy)^2 <= r^2`` (the paper's Figure 1 and equation 1).
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import BLOCK, ROWS
from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.normal_levels import LEVELS, level_slopes

__all__ = ["EMPTY_SCANS", "LEVELS", "SIZES", "level_slopes", "row_span", "shape_table"]

SIZES = 17
"""Diameters of the table: 0..16 pixels."""

EMPTY_SCANS = 0b000001_000001_000001_000001
"""SCANS of four empty rows: each has first 1 and last 0."""


@nb.njit(inline="always")
def row_span(dy: float, slope_x: float, slope_y: float, radius: float) -> tuple[float, float]:
    """Return the ends of the ellipse on a row: (left, right); left > right if it misses the row.

    Solves (1 + n'x^2) dx^2 + 2 n'x n'y dy dx + (1 + n'y^2) dy^2 - r^2 <= 0 for dx.
    """
    a = 1.0 + slope_x * slope_x
    half_b = slope_x * slope_y * dy
    c = (1.0 + slope_y * slope_y) * dy * dy - radius * radius
    discriminant = half_b * half_b - a * c
    if discriminant < 0.0:
        return 1.0, -1.0
    root = math.sqrt(discriminant)
    return (-half_b - root) / a, (-half_b + root) / a


@functools.cache
def shape_table() -> npt.NDArray[np.uint32]:
    """Return the SCANS of every size and normal: shape (17, 64, 64, 4), uint32.

    Indices: diameter in pixels, level of n'x, level of n'y, fraction. The ellipse's centre is a
    corner of the pixel grid.

    Diameters up to 8 have the four upper rows of an 8 x 8 block in fraction 0; the lower four
    are their half rotation (MODE 0). Diameters 9..16 have the upper eight rows of a 16 x 16 block:
    fractions 0 and 1 hold columns 0..7 and 8..15 of rows 0..3, fractions 2 and 3 of rows 4..7; the
    lower rows are their half rotation. Empty fractions are ``EMPTY_SCANS``.

    No entry is empty, so that a closed surface gets no holes at its silhouette. An ellipse that
    covers no pixel's centre has the two pixels nearest to its centre in the ellipse's own metric.
    (Diameters 0 and 1 are drawn as one pixel and do not use their entries.)
    """
    return _build_table(level_slopes())


@cached_njit()
def _build_table(slopes: Any) -> Any:
    table = np.empty((SIZES, LEVELS, LEVELS, 4), np.uint32)
    for size in range(SIZES):
        half = BLOCK // 2 if size <= BLOCK else BLOCK
        for x in range(LEVELS):
            for y in range(LEVELS):
                for fraction in range(4):
                    table[size, x, y, fraction] = EMPTY_SCANS
                filled = False
                for row in range(half):
                    left, right = row_span(row + 0.5 - half, slopes[x], slopes[y], 0.5 * size)
                    # Pixel c has its centre at c + 0.5 - half.
                    first = max(math.ceil(left + half - 0.5), 0)
                    last = min(math.floor(right + half - 0.5), 2 * half - 1)
                    if first <= last:
                        filled = True
                        _set_row(table[size, x, y], row, first, last)
                if not filled:
                    column = _nearest_column(half, slopes[x], slopes[y])
                    _set_row(table[size, x, y], half - 1, column, column)
    return table


@nb.njit(inline="always")
def _set_row(fractions: Any, row: int, first: int, last: int) -> None:
    """Write a row of a block into its fractions."""
    for part in range(2):
        low = max(first - BLOCK * part, 0)
        high = min(last - BLOCK * part, BLOCK - 1)
        if low <= high:
            at = 6 * (row % ROWS)
            fraction = 2 * (row // ROWS) + part
            kept = fractions[fraction] & ~np.uint32(63 << at)
            fractions[fraction] = kept | np.uint32((low | high << 3) << at)


@nb.njit
def _nearest_column(half: int, slope_x: float, slope_y: float) -> int:
    """Return the pixel nearest by the ellipse's metric in the row above its centre."""
    nearest = half
    least = math.inf
    for column in range(2 * half):
        dx, dy = column + 0.5 - half, -0.5
        across = slope_x * dx + slope_y * dy
        distance = dx * dx + dy * dy + across * across
        if distance < least:
            nearest, least = column, distance
    return nearest
