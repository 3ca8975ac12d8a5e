"""Writing code words: clipping a fraction's rows, turning a block, counting before writing."""

from __future__ import annotations

from typing import Any

import numba as nb

from ..rtl.format import BLOCK, ROWS
from .shapes import EMPTY_SCANS

__all__ = ["LARGEST", "ONE_PIXEL", "emit", "put", "turned"]

LARGEST = float(1 << 24)
"""Pixels beyond which a coordinate is far outside every image; exact in float32."""

ONE_PIXEL = EMPTY_SCANS & ~63
"""SCANS of a fraction whose only pixel is the first of its first row."""

# Where words go: (words, lines, width, height, lsb of X, whether to write or only to count). Every
# function here takes the number of words before it and returns the number after it.


@nb.njit
def emit(scans: int, x: int, top: int, common: int, at: int, to: Any) -> int:
    """Write a fraction with its first row on line ``top``, clipped on the left; none if empty."""
    _, _, width, height, x_lsb, _ = to
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
    return put(common | 1 | clipped << 1 | max(x, 0) << x_lsb, top + ROWS, at, to)


@nb.njit
def turned(scans: int) -> int:
    """Return four rows turned by 180 degrees: in reverse order, and each from right to left."""
    result = 0
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        result |= ((7 - last) | (7 - first) << 3) << 6 * (ROWS - 1 - row)
    return result


@nb.njit
def put(word: int, line: int, at: int, to: Any) -> int:
    """Write a word, unless words are only being counted."""
    words, lines, _, _, _, write = to
    if write:
        words[at] = word
        lines[at] = line
    return at + 1
