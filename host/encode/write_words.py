"""Writing code words: a fraction, a block about its middle, clipped and turned."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS
from splatline.host.visibility.view import LARGEST

from .shape_table import EMPTY_SCANS

__all__ = [
    "ONE_PIXEL",
    "corner",
    "emit",
    "put",
    "put_block",
    "put_symmetric",
    "quantised_depth",
    "turned",
]

ONE_PIXEL = EMPTY_SCANS & ~63
"""SCANS of a fraction whose only pixel is the first of its first row."""

# Where words go: (words, lines, width, height, lsb of X, lsb of Z, largest Z). Every function here
# takes the place of the next word and returns the place after what it wrote.


@nb.njit(inline="always")
def quantised_depth(depth: float, largest: int) -> int:
    """Return the code of a depth given as a share of the frame's range."""
    # Not a number, as a range of 0 makes of a plane at infinity, counts as nearest.
    depth = depth if depth > 0.0 else 0.0
    return int((depth if depth < 1.0 else 1.0) * largest + 0.5)


@nb.njit
def emit(scans: int, x: int, top: int, common: int, at: int, to: Any) -> int:
    """Write a fraction with its first row on line ``top``, clipped on the left; none if empty."""
    width, height = to[2], to[3]
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
def turned(scans: int) -> int:
    """Return four rows turned by 180 degrees: in reverse order, and each from right to left."""
    result = 0
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        result |= ((7 - last) | (7 - first) << 3) << 6 * (ROWS - 1 - row)
    return result


@nb.njit
def put(common: int, scans: int, x: int, top: int, at: int, to: Any) -> int:
    """Write a fraction that needs no clipping."""
    words, lines, _, _, x_lsb, _, _ = to
    words[at] = common | 1 | scans << 1 | x << x_lsb
    lines[at] = top + ROWS
    return at + 1


@nb.njit
def put_symmetric(common: int, scans: int, x: int, line: int, at: int, to: Any) -> int:
    """Write a symmetric shape whose middle lies above ``line``; its X is at least 0."""
    words, lines, _, _, x_lsb, _, _ = to
    words[at] = common | scans << 1 | x << x_lsb
    lines[at] = line
    return at + 1


@nb.njit(inline="always")
def corner(place: float) -> int:
    """Return the nearest border of pixels; further off than any integer is far enough."""
    return math.floor(min(max(place, -LARGEST), LARGEST) + 0.5)


@nb.njit
def put_block(
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
