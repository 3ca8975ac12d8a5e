"""Decodes a code word: the columns that it covers on its block's eight lines, and its depths."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from .config import BLOCK, ROWS, EngineConfig
from .plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION
from .presets import PAPER, PLANE

__all__ = [
    "COLUMN",
    "FIRST",
    "LAST",
    "decode_plane_word",
    "decode_word",
    "plane_at",
    "plane_fields",
]

SHIFT = np.array(SHIFTS, np.int64)

# The scans have the same position in every configuration, so it is a constant for the compiler.
FIRST = tuple(PAPER.first(row).lsb for row in range(ROWS))
LAST = tuple(PAPER.last(row).lsb for row in range(ROWS))
COLUMN = PAPER.first(0).mask

# So have the fields of a plane word that shape it.
SIDE = tuple(tuple(PLANE.side(row, end).lsb for end in range(2)) for row in range(ROWS))
RAISED = PLANE.raised.lsb - LOW_BITS
OUTWARDS = tuple(PLANE.outwards(end).lsb - LOW_BITS for end in range(2))


@nb.njit(cache=True)
def decode_word(word: int, rows: Any) -> int:
    """Set the rows of an element's block: first and last column, first > last if it is empty.

    See ``docs/contract.md``, "Half pixels". Columns are 0..8.

    Parameters
    ----------
    word
        A code word that is neither a control word nor a compact one: int64, the bits of an unsigned
        one.
    rows
        Shape (8, 2), int64.

    Returns
    -------
    int
        Columns by which the rotated rows lie further right, 0 or 1.
    """
    for row in range(ROWS):
        rows[row, 0], rows[row, 1] = word >> FIRST[row] & COLUMN, word >> LAST[row] & COLUMN
    rows[ROWS:, 0], rows[ROWS:, 1] = 1, 0
    if word & 1:
        return 0
    middle = ROWS - 1
    raised = int(rows[middle, 0] >= ROWS > rows[middle, 1])
    if raised:
        rows[middle, 0], rows[middle, 1] = rows[middle, 1], rows[middle, 0]
        right = int((rows[middle, 0] + rows[middle, 1]) % 2 == 0)
    else:
        right = int(rows[0, 0] > rows[0, 1] and rows[0, 0] & 2 != 0)
    for row in range(ROWS - raised):
        if rows[row, 0] <= rows[row, 1]:
            below = BLOCK - 1 - raised - row
            rows[below, 0] = BLOCK - 1 + right - rows[row, 1]
            rows[below, 1] = BLOCK - 1 + right - rows[row, 0]
    return right


@nb.njit(cache=True)
def decode_plane_word(low: int, high: int, rows: Any) -> None:
    """Set the rows of a plane word's block: first and last column, first > last if it is empty.

    See ``docs/contract.md``, "Plane words".

    Parameters
    ----------
    low, high
        The halves of a plane word that is no control word: int64, the bits of unsigned ones.
    rows
        Shape (8, 2), int64.
    """
    for row in range(ROWS):
        rows[row, 0], rows[row, 1] = low >> FIRST[row] & COLUMN, low >> LAST[row] & COLUMN
    rows[ROWS:, 0], rows[ROWS:, 1] = 1, 0
    if low & 1:
        return
    raised = high >> RAISED & 1
    first_way = -1 if high >> OUTWARDS[0] & 1 else 1
    last_way = 1 if high >> OUTWARDS[1] & 1 else -1
    for row in range(ROWS - raised):
        if rows[row, 0] <= rows[row, 1]:
            below = BLOCK - 1 - raised - row
            first = BLOCK - 1 - rows[row, 1] + first_way * (low >> SIDE[row][0] & 1)
            last = BLOCK - 1 - rows[row, 0] + last_way * (low >> SIDE[row][1] & 1)
            rows[below, 0] = min(max(first, 0), BLOCK - 1)
            rows[below, 1] = min(max(last, 0), BLOCK - 1)


def plane_fields(config: EngineConfig) -> tuple[int, int, int, int, int, int]:
    """Return where :func:`plane_at` finds a plane, in the high half of a configuration's words."""
    lsbs = (config.slope_x.lsb, config.slope_y.lsb, config.scale.lsb, config.z.lsb)
    x, y, scale, z = (lsb - LOW_BITS for lsb in lsbs)
    return x, y, config.slope_bits, scale, z, config.z.mask


@nb.njit(cache=True)
def plane_at(high: int, fields: Any) -> tuple[int, int, int]:
    """Return a plane's depth at row 0, column 0 of the block, and its change from pixel to pixel.

    All have ``SUM_FRACTION`` fraction bits; see ``docs/contract.md``, "Depth".

    Parameters
    ----------
    high
        The high half of a plane word: int64.
    fields
        See :func:`plane_fields`.

    Returns
    -------
    start, a, b
        The depth, and its change from column to column and from line to line.
    """
    x_lsb, y_lsb, slope_bits, scale_lsb, z_lsb, z_mask = fields
    shift = SHIFT[high >> scale_lsb & 3]
    half = 1 << slope_bits - 1
    a = ((high >> x_lsb & 2 * half - 1 ^ half) - half) << shift
    b = ((high >> y_lsb & 2 * half - 1 ^ half) - half) << shift
    return (high >> z_lsb & z_mask) << SUM_FRACTION - Z_FRACTION, a, b
