"""Symmetric elements of their true size and shape, with their middle at a half pixel."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS

from .shape_table import EMPTY_SCANS
from .write_words import ONE_PIXEL, corner, put_block, write_fraction

__all__ = ["encode_half_pixel", "fits_block"]

LARGEST_EXTENT = 10.0
"""Columns and lines, in pixels, of the largest ellipse that may be drawn in a block of 8 x 8."""

MOST_LOST = 1.5
"""Pixels of such an ellipse that may lie beyond the block, and are left out. More would save words
and cost accuracy (decision 0027)."""


@nb.njit(error_model="numpy")
def fits_block(column: float, line: float, square: float, form: Any) -> bool:
    """Return whether the block about the nearest corner of half pixels has an ellipse's pixels.

    It has all but :data:`MOST_LOST`. Half a column further right, the upper rows have the block's
    first column, and the lower ones its ninth. A pixel there counts half, so that a mirrored
    ellipse is drawn alike. The bounding box of the ellipse has sides of 2 sqrt(C square / D) and
    2 sqrt(A square / D), where A, B, C is its form and D the determinant.
    Parameters are those of :func:`encode_half_pixel`.
    """
    a, b, c, determinant = form
    if max(a, c) * square > 0.25 * LARGEST_EXTENT * LARGEST_EXTENT * determinant:
        return False
    twice_x, twice_y = corner(2.0 * column), corner(2.0 * line)
    half_lines = math.sqrt(a * square / determinant)
    inverse = 1.0 / a
    begin, right = (twice_x >> 1) - ROWS, twice_x & 1
    end = begin + BLOCK - 1 + right
    lost = 0.0
    for y in range(math.floor(line - half_lines), math.floor(line + half_lines) + 1):
        dv = y + 0.5 - line
        rest = a * square - determinant * dv * dv
        if rest < 0.0:
            continue
        half, middle = math.sqrt(rest) * inverse, column - b * dv * inverse - 0.5
        first, last = math.ceil(middle - half), math.floor(middle + half)
        lost += last - first + 1
        if abs(2 * y + 1 - twice_y) < BLOCK:
            lost -= max(0, min(last, end) - max(first, begin) + 1)
            if right:
                lost += 0.5 * ((first <= begin <= last) + (first <= end <= last))
    return lost <= MOST_LOST


@nb.njit(error_model="numpy")
def encode_half_pixel(
    column: float, line: float, square: float, form: Any, common: int, at: int, to: Any
) -> int:
    """Write an ellipse of its true size and shape, within 8 x 8 pixels, as one symmetric word.

    The middle is the corner of half pixels nearest to the ellipse's centre, so the rows are their
    own half rotation. If the rows leave no room to mark that middle, the nearest whole line or
    column is used. An ellipse that covers no pixel's centre there is drawn as the pixel that holds
    its centre.

    Parameters
    ----------
    column, line
        Centre on the image.
    square, form
        The ellipse; see :mod:`splatline.host.encode.ellipse`.
    common, at, to
        See :func:`splatline.host.encode.paper_shapes.encode_symmetric`.
    """
    twice_x, twice_y = corner(2.0 * column), corner(2.0 * line)
    # Tries the nearest corner of half pixels, then its neighbours. One of them is a pixel's corner.
    off_x, off_y = 2.0 * column - twice_x, 2.0 * line - twice_y
    next_x, next_y = -1 if off_x < 0.0 else 1, -1 if off_y < 0.0 else 1
    x_first = abs(off_x) > abs(off_y)
    right, raised, scans = 0, 0, EMPTY_SCANS
    for attempt in range(4):
        to_x, to_y = attempt & 1, attempt >> 1
        if not x_first:
            to_x, to_y = to_y, to_x
        x, y = twice_x + to_x * next_x, twice_y + to_y * next_y
        right, raised = x & 1, y & 1
        scans = _upper_half(square, form, right, raised)
        if _has_word(scans, right, raised, form, square):
            twice_x, twice_y = x, y
            break
    if scans == EMPTY_SCANS:
        return write_fraction(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
    return put_block(twice_x >> 1, twice_y + 1 >> 1, right, raised, scans, common, at, to)


@nb.njit(inline="always")
def _has_word(scans: int, right: int, raised: int, form: Any, square: float) -> bool:
    """Return whether a symmetric word has room to mark the middle of these rows.

    A raised shape has seven lines, and its middle line more than one pixel and the right parity. A
    shape half a column to the right has seven columns.
    """
    if right:
        for row in range(ROWS):
            if scans >> 6 * row & 7 == 0:
                return False
    if raised:
        first, last = scans >> 6 * (ROWS - 1) & 7, scans >> 6 * (ROWS - 1) + 3 & 7
        fits = form[0] * square <= form[3] * float(ROWS * ROWS)
        return fits and first < last and (first + last) % 2 == 1 - right
    return not right or (scans & 7) > (scans >> 3 & 7)


@nb.njit(inline="always")
def _upper_half(square: float, form: Any, right: int, raised: int) -> int:
    """Return rows 0..3 of an ellipse in the middle of its block.

    ``right``, ``raised``: the middle lies half a column further right, half a line higher.
    """
    a, b, _, determinant = form
    inverse = 1.0 / a
    scans = 0
    for row in range(ROWS):
        dv = row + 0.5 * (1 + raised) - ROWS
        rest = a * square - determinant * dv * dv
        half = math.sqrt(rest if rest > 0.0 else 0.0) * inverse
        # Pixel c has its centre at c + 0.5.
        middle = 0.5 * (BLOCK - 1 + right) - b * dv * inverse
        low, high = max(middle - half, 0.0), min(middle + half, BLOCK - 1.0)
        first, last = math.ceil(min(low, float(BLOCK))), math.floor(max(high, -1.0))
        scans |= ((first | last << 3) if rest >= 0.0 and first <= last else 1) << 6 * row
    return scans
