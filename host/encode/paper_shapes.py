"""The paper's elements: whole positions, whole diameters, shapes from the table."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS
from splatline.host.visibility.view import LARGEST

from .shape_table import SIZES, row_span
from .tile import first_column_of, first_line_of, first_part
from .write_words import ONE_PIXEL, corner, half_turn, put_block, write_fraction

__all__ = ["encode_symmetric"]


@nb.njit
def encode_symmetric(
    column: float,
    line: float,
    diameter: float,
    shape: tuple[int, int],
    table: Any,
    slopes: Any,
    common: int,
    at: int,
    to: Any,
) -> int:
    """Write a splat's words; see :mod:`splatline.host.encode.write_words` for ``at`` and ``to``.

    Diameters are rounded up. About a pixel corner a disc of 3 pixels covers no more than one of 2,
    and rounding to nearest leaves three to ten times the holes (decision 0002).

    - Diameters up to 1 pixel: the pixel that holds the centre, one fraction (MODE 1).
    - Up to 8: the shape table's block, its middle at the pixel corner nearest to the centre, one
      symmetric word (MODE 0); as two fractions where it crosses the upper or left border.
    - Above: fractions of 8 x 4 pixels, from the table up to 16 and from the ellipse itself beyond.
      A splat that covers no pixel's centre is drawn as the pixel that holds its centre.

    Parameters
    ----------
    column, line
        Centre on the image.
    diameter
        In pixels.
    shape
        Levels of n'x and n'y.
    table, slopes
        The shape table, and the slopes of its levels.
    common
        The words' bits that do not depend on the shape, Z among them.
    """
    size = math.ceil(min(diameter, 2.0 * LARGEST))
    if size <= 1:
        return write_fraction(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)

    x, y = corner(column), corner(line)
    level_x, level_y = shape
    if size <= BLOCK:
        scans = int(table[size, level_x, level_y, 0])
        return put_block(x, y, 0, 0, scans, common, at, to)

    if size < SIZES:
        upper = table[size, level_x, level_y]
        x -= BLOCK
        for fraction in range(4):
            scans = int(upper[fraction])
            dx, dy = BLOCK * (fraction % 2), ROWS * (fraction // 2)
            at = write_fraction(scans, x + dx, y - 2 * ROWS + dy, common, at, to)
            at = write_fraction(half_turn(scans), x + BLOCK - dx, y + ROWS - dy, common, at, to)
        return at
    slope_x, slope_y = slopes[level_x], slopes[level_y]
    end = _encode_large(x, y, 0.5 * size, slope_x, slope_y, common, at, to)
    if end == at and not _covers_some(x, y, 0.5 * size, slope_x, slope_y, to.width, to.height):
        return write_fraction(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
    return end


@nb.njit
def _encode_large(
    x: int, y: int, radius: float, slope_x: float, slope_y: float, common: int, at: int, to: Any
) -> int:
    """Write the fractions of an ellipse of any size about the pixel corner (x, y)."""
    width, height = to.width, to.height
    begin_block, end_block = _blocks(y, radius, first_line_of(to), to.bottom, height)
    for block in range(begin_block, end_block):
        top = y + ROWS * block
        left, right = _block_extent(block, radius, slope_x, slope_y)
        first_column = max(x + left, 0)
        last_column = min(x + right, width - 1)
        first_begin = first_part(first_column, BLOCK, first_column_of(to))
        for begin in range(first_begin, min(last_column + 1, to.right), BLOCK):
            scans = 0
            for row in range(ROWS):
                a, b = _row_pixels(block, row, radius, slope_x, slope_y)
                first = max(x + a - begin, 0)
                last = min(x + b - begin, BLOCK - 1)
                filled = first <= last
                scans |= ((first | last << 3) if filled else 1) << 6 * row
            at = write_fraction(scans, begin, top, common, at, to)
    return at


@nb.njit(inline="always")
def _blocks(y: int, radius: float, top: int, bottom: int, height: int) -> tuple[int, int]:
    """Return the first block of four lines that reaches lines of the image, and the one behind.

    Parameters
    ----------
    y, radius
        Of the ellipse.
    top, bottom
        First line, and the line behind the last.
    height
        Of the image.
    """
    # However large the ellipse is.
    blocks = math.ceil(min(radius, 4.0 * (abs(y) + height)) / ROWS)
    return max(-blocks, (top - y) // ROWS), min(blocks, -((y - bottom) // ROWS))


@nb.njit
def _covers_some(
    x: int, y: int, radius: float, slope_x: float, slope_y: float, width: int, height: int
) -> bool:
    """Return whether an ellipse covers the centre of any pixel of the whole image.

    If it does not, it is so thin that no line of pixels' centres meets it, or lies outside.
    """
    begin_block, end_block = _blocks(y, radius, 0, height, height)
    for block in range(begin_block, end_block):
        for row in range(ROWS):
            if 0 <= y + ROWS * block + row < height:
                left, right = _row_pixels(block, row, radius, slope_x, slope_y)
                if max(x + left, 0) <= min(x + right, width - 1):
                    return True
    return False


@nb.njit
def _row_pixels(
    block: int, row: int, radius: float, slope_x: float, slope_y: float
) -> tuple[int, int]:
    """Return the first and last pixel, from the centre on, of a row of the ellipse."""
    left, right = row_span(ROWS * block + row + 0.5, slope_x, slope_y, radius)
    # An ellipse may be wider than an integer holds.
    left, right = max(left, -LARGEST), min(right, LARGEST)
    return math.ceil(left - 0.5), math.floor(right - 0.5)


@nb.njit
def _block_extent(block: int, radius: float, slope_x: float, slope_y: float) -> tuple[int, int]:
    """Return the first and last pixel of four rows together; first > last if all are empty."""
    left, right = 1 << 30, -(1 << 30)
    for row in range(ROWS):
        a, b = _row_pixels(block, row, radius, slope_x, slope_y)
        if a <= b:
            left, right = min(left, a), max(right, b)
    return left, right
