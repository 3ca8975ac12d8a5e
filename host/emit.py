"""Writing code words: a fraction's bits, clipping its rows, turning a block."""

from __future__ import annotations

from typing import Any

import numba as nb

from ..rtl.format import BLOCK, ROWS
from .shapes import EMPTY_SCANS

__all__ = ["LARGEST", "ONE_PIXEL", "emit", "put", "put_symmetric", "turned"]

LARGEST = float(1 << 24)
"""Pixels beyond which a coordinate is far outside every image; exact in float32."""

ONE_PIXEL = EMPTY_SCANS & ~63
"""SCANS of a fraction whose only pixel is the first of its first row."""

# Where words go: (words, lines, width, height, lsb of X, lsb of Z, largest Z). Every function here
# takes the place of the next word and returns the place after what it wrote.


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
