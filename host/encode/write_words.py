"""Writes code words: fractions and symmetric words, clipped to the image, those of a tile alone."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS
from splatline.host.visibility.view import LARGEST

from .shape_table import EMPTY_SCANS
from .tile import may_touch

__all__ = [
    "ONE_PIXEL",
    "corner",
    "half_turn",
    "put",
    "put_block",
    "put_symmetric",
    "quantised_depth",
    "write_fraction",
]

ONE_PIXEL = EMPTY_SCANS & ~63
"""SCANS of a fraction whose only pixel is the first of its first row."""

# Every function here takes the slot of the next word, and where words go (``tile.Target``), and
# returns the slot after the words that it wrote. Columns and lines are those of the whole image.


@nb.njit(inline="always")
def quantised_depth(depth: float, largest: int) -> int:
    """Return the code of a depth given as a share of the frame's range."""
    # NaN counts as nearest. It comes from a depth range of 0 and a plane at infinity.
    depth = depth if depth > 0.0 else 0.0
    return int((depth if depth < 1.0 else 1.0) * largest + 0.5)


@nb.njit
def write_fraction(scans: int, x: int, top: int, common: int, at: int, to: Any) -> int:
    """Write a fraction with its first row on line ``top``, clipped on the left, unless empty."""
    width, height = to.width, to.height
    x, top = int(x), int(top)
    if x >= width or x <= -BLOCK or top >= height or top <= -ROWS:
        return at
    clipped = 0
    visible = False
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        if x < 0:
            first, last = max(first + x, 0), last + x
        if first <= last and 0 <= top + row < height and x + first < width:
            clipped |= (first | last << 3) << 6 * row
            visible = True
        else:
            clipped |= 1 << 6 * row
    if not visible:
        return at
    return put(common, clipped, max(x, 0), top, at, to)


@nb.njit
def half_turn(scans: int) -> int:
    """Return the half rotation of four rows: in reverse order, each from right to left."""
    result = 0
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        result |= ((7 - last) | (7 - first) << 3) << 6 * (ROWS - 1 - row)
    return result


@nb.njit
def put(common: int, scans: int, x: int, top: int, at: int, to: Any) -> int:
    """Write a fraction that needs no clipping, if it may touch the tile."""
    return put_symmetric(common | 1, scans, x, top + ROWS, at, to)


@nb.njit
def put_symmetric(common: int, scans: int, x: int, line: int, at: int, to: Any) -> int:
    """Write a symmetric shape whose middle lies above ``line``, if it may touch the tile.

    Its X is at least 0.
    """
    words, lines, _, _, origin_x, origin_y, right, bottom, x_lsb, _, _ = to
    words[at] = common | scans << 1 | x - origin_x << x_lsb
    lines[at] = line - origin_y
    return at + may_touch(x, line, origin_x, origin_y, right, bottom)


@nb.njit(inline="always")
def corner(position: float) -> int:
    """Return the nearest border between pixels, clipped to what an integer holds."""
    return math.floor(min(max(position, -LARGEST), LARGEST) + 0.5)


@nb.njit
def put_block(
    x: int, y: int, right: int, raised: int, scans: int, common: int, at: int, to: Any
) -> int:
    """Write the block about a pixel corner.

    It is two fractions if a symmetric word would start outside of the image. ``right`` and
    ``raised``: the middle lies half a column right of the corner, and half a line above it.
    """
    width, height = to.width, to.height
    x -= BLOCK // 2
    if x >= 0 and y >= 0:
        if x >= width or y - ROWS >= height:
            return at
        return put_symmetric(common, _mark_middle(scans, right, raised), x, y, at, to)
    at = write_fraction(scans, x, y - ROWS, common, at, to)
    lower = half_turn(scans)
    if raised:  # row 3 is its own half rotation
        lower = lower & ~63 | 1
    return write_fraction(lower, x + right, y - raised, common, at, to)


@nb.njit(inline="always")
def _mark_middle(scans: int, right: int, raised: int) -> int:
    """Return the rows of a symmetric word with its middle marked (``docs/contract.md``).

    Row 3 of a raised shape has its ends exchanged; their parity tells the middle's column. If the
    middle of another shape lies half a column to the right, row 0 is empty and its first column is
    the mark.
    """
    at = 6 * (ROWS - 1)
    if raised:
        return scans & (1 << at) - 1 | (scans >> at + 3 | (scans >> at & 7) << 3) << at
    return scans & ~63 | 2 if right else scans
