"""Symmetric elements: of true size at half places; the paper's from the table, at whole ones."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from ..rtl.format import BLOCK, ROWS
from .emit import LARGEST, ONE_PIXEL, emit, put_symmetric, turned
from .shapes import EMPTY_SCANS, SIZES, row_span

__all__ = ["corner", "encode_symmetric", "encode_turned"]


@nb.njit(error_model="numpy")
def encode_turned(
    column: float, line: float, square: float, form: Any, common: int, at: int, to: Any
) -> int:
    """Write an ellipse of up to 8 x 8 pixels, of its true size and shape, as one symmetric word.

    Its middle is the corner of half pixels nearest to its centre; so it is its own half turn. Where
    the word has no room for that, as what would say so is taken up by pixels, it is the nearest
    whole line, or column. One that covers no pixel's centre there is drawn as the pixel that holds
    its own.

    Parameters
    ----------
    column, line
        Centre on the image.
    square, form
        The ellipse; see :mod:`splatline.host.exact`.
    common, at, to
        See ``encode_symmetric``.
    """
    twice_x, twice_y = corner(2.0 * column), corner(2.0 * line)
    # The nearest corner of half pixels; then its neighbours, of which one is a pixel's corner.
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
        return emit(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
    return _put_block(twice_x >> 1, twice_y + 1 >> 1, right, raised, scans, common, at, to)


@nb.njit(inline="always")
def _has_word(scans: int, right: int, raised: int, form: Any, square: float) -> bool:
    """Return whether a symmetric word can say that the middle of these rows is where it is.

    A raised shape has seven lines, and more than a pixel in its middle one, whose ends are as even
    as that says. One that lies half a column off has seven columns.
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
    """Write a splat's words; see :mod:`splatline.host.emit` for ``at`` and ``to``.

    Diameters are rounded up: about a pixel corner a disc of 3 pixels covers no more than one of 2,
    and rounding to nearest left three to ten times the holes (``docs/decisions.md``).

    - Diameters up to 1 pixel: the pixel that holds the centre, one fraction (MODE 1).
    - Up to 8: the shape table's block, its middle at the pixel corner nearest to the centre, one
      symmetric word (MODE 0); as two fractions where it crosses the upper or left border.
    - Above: fractions of 8 x 4 pixels, from the table up to 16 and from the ellipse itself beyond;
      one that covers no pixel's centre draws the pixel that holds its own.

    Parameters
    ----------
    column, line
        Centre on the image.
    diameter
        In pixels.
    shape
        Levels of n'x and n'y.
    table, slopes
        The shape table and what its levels stand for.
    common
        The words' bits that do not depend on the shape, Z among them.
    """
    size = math.ceil(min(diameter, 2.0 * LARGEST))
    if size <= 1:
        return emit(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)

    x, y = corner(column), corner(line)
    level_x, level_y = shape
    if size <= BLOCK:
        scans = int(table[size, level_x, level_y, 0])
        return _put_block(x, y, 0, 0, scans, common, at, to)

    if size < SIZES:
        upper = table[size, level_x, level_y]
        x -= BLOCK
        for fraction in range(4):
            scans = int(upper[fraction])
            dx, dy = BLOCK * (fraction % 2), ROWS * (fraction // 2)
            at = emit(scans, x + dx, y - 2 * ROWS + dy, common, at, to)
            at = emit(turned(scans), x + BLOCK - dx, y + ROWS - dy, common, at, to)
        return at
    end = _encode_large(x, y, 0.5 * size, slopes[level_x], slopes[level_y], common, at, to)
    if end == at:  # so thin that it covers no pixel's centre
        return emit(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
    return end


@nb.njit(inline="always")
def corner(place: float) -> int:
    """Return the nearest border of pixels; further off than any integer is far enough."""
    return math.floor(min(max(place, -LARGEST), LARGEST) + 0.5)


@nb.njit
def _put_block(
    x: int, y: int, right: int, raised: int, scans: int, common: int, at: int, to: Any
) -> int:
    """Write the block about a pixel corner, as two fractions where one word would start outside.

    ``right``, ``raised``: the middle lies half a column right of the corner, half a line above it.
    """
    width, height = to[2], to[3]
    x -= BLOCK // 2
    if x >= 0 and y >= 0:
        if x >= width or y - ROWS >= height:
            return at
        return put_symmetric(common, _mark_middle(scans, right, raised), x, y, at, to)
    at = emit(scans, x, y - ROWS, common, at, to)
    lower = turned(scans)
    if raised:  # row 3 is its own half turn
        lower = lower & ~63 | 1
    return emit(lower, x + right, y - raised, common, at, to)


@nb.njit(inline="always")
def _mark_middle(scans: int, right: int, raised: int) -> int:
    """Return the rows of a symmetric word as they say where its middle is (``docs/contract.md``).

    A raised shape's row 3 has its ends exchanged, which are as even as its middle says. Of others
    the first row is empty if the middle lies half a column off, and says it by its first column.
    """
    at = 6 * (ROWS - 1)
    if raised:
        return scans & (1 << at) - 1 | (scans >> at + 3 | (scans >> at & 7) << 3) << at
    return scans & ~63 | 2 if right else scans


@nb.njit
def _encode_large(
    x: int, y: int, radius: float, slope_x: float, slope_y: float, common: int, at: int, to: Any
) -> int:
    """Write the fractions of an ellipse of any size about the pixel corner (x, y)."""
    width, height = to[2], to[3]
    # Only the blocks that reach into the image, however large the ellipse is.
    blocks = math.ceil(min(radius, 4.0 * (abs(y) + height)) / ROWS)
    begin_block = max(-blocks, -(y // ROWS) - 1)
    end_block = min(blocks, (height - y) // ROWS + 1)
    for block in range(begin_block, end_block):
        top = y + ROWS * block
        if top >= height or top + ROWS <= 0:
            continue
        left, right = _block_extent(block, radius, slope_x, slope_y)
        first_column = max(x + left, 0)
        last_column = min(x + right, width - 1)
        for begin in range(first_column, last_column + 1, BLOCK):
            scans = 0
            for row in range(ROWS):
                a, b = _row_pixels(block, row, radius, slope_x, slope_y)
                first = max(x + a - begin, 0)
                last = min(x + b - begin, BLOCK - 1)
                filled = first <= last
                scans |= ((first | last << 3) if filled else 1) << 6 * row
            at = emit(scans, begin, top, common, at, to)
    return at


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
