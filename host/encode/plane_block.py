"""Ellipses of up to 8 x 8 pixels as one symmetric plane word, its lower rows nearly true."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS

__all__ = ["TRUE_ROWS", "encode_block", "row_ends"]

HALF = BLOCK // 2

TRUE_ROWS = BLOCK + 2
"""Most rows that are looked at: an ellipse of eight rows may seem to reach one further each way."""


@nb.njit(inline="always", error_model="numpy")
def row_ends(
    row: int, column: float, line: float, square: float, form: Any
) -> tuple[int, int, bool]:
    """Return first and last pixel of an ellipse's row, inside or outside the image, if any.

    See :func:`splatline.host.encode.ellipse.span`; the parameters are those of ``one_fraction``.
    """
    inverse = 1.0 / form[0]
    dv = row + 0.5 - line
    rest = form[0] * square - form[3] * dv * dv
    half = math.sqrt(rest if rest > 0.0 else 0.0) * inverse
    middle = column - form[1] * inverse * dv - 0.5
    first, last = math.ceil(middle - half), math.floor(middle + half)
    return first, last, (rest >= 0.0) & (first <= last)


@nb.njit(error_model="numpy")
def encode_block(
    column: float, line: float, square: float, form: Any, rows: Any, layout: Any
) -> tuple[bool, int, int, int, int]:
    """Return an ellipse of up to 8 x 8 pixels as rows of one plane word, mostly a symmetric one.

    If at most four lines have pixels it is a fraction. Else the upper rows are true, and the lower
    ones are their half rotation about a middle at a whole column and a whole or half line, with
    each end moved by a column where that is nearer to the truth. Of the middles next to the
    ellipse's centre, and of the two ways that either end may move, those with the fewest wrong
    pixels are taken: 0 for seven elements of eight (decision 0099).

    Parameters
    ----------
    column, line, square, form
        The ellipse; see :func:`splatline.host.encode.ellipse.one_fraction`.
    rows
        Scratch: shape (TRUE_ROWS, 2), int64.
    layout
        Positions of the fields.

    Returns
    -------
    found
        Whether it fits a block.
    low, high
        Bits of the rows: MODE, SCANS, SIDES; RAISED, OUTWARDS.
    x, y
        Image column of the block's first column, image line of its first row.
    """
    reach = math.sqrt(form[0] / form[3] * square)
    if not reach < HALF + 1.0:
        return False, 0, 0, 0, 0
    start = math.ceil(line - reach - 0.5)
    top, bottom, left, right = 1 << 30, -(1 << 30), 1 << 30, -(1 << 30)
    for k in range(TRUE_ROWS):
        rows[k, 0], rows[k, 1] = 1, 0
        first, last, filled = row_ends(start + k, column, line, square, form)
        if filled:
            rows[k, 0], rows[k, 1] = first, last
            top, bottom = min(top, k), max(bottom, k)
            left, right = min(left, first), max(right, last)
    if not 0 <= bottom - top < BLOCK or right - left >= BLOCK:
        return False, 0, 0, 0, 0
    if bottom - top < ROWS:  # its extent has more lines than those with pixels
        return True, _scans(rows, top, left) << 1 | 1, 0, left, start + top
    middle_x, twice_y = math.floor(column + 0.5), math.floor(2.0 * line + 0.5)
    beside = 1 if column >= middle_x else -1
    above = 1 if 2.0 * line >= twice_y else -1
    best, chosen, x, half_line = 1 << 30, 0, 0, 0
    for attempt in range(9):
        # The nearest middle first.
        tried_x = middle_x - HALF + (0, beside, -beside)[attempt % 3]
        tried_y = twice_y + (0, above, -above)[attempt // 3]
        raised = tried_y & 1
        first_row = (tried_y + 1 >> 1) - HALF - start
        inside = tried_x <= left and right < tried_x + BLOCK and first_row <= top
        if not inside or bottom >= first_row + BLOCK - raised:
            continue
        wrong, ways = _fewest_wrong(rows, first_row, tried_x, raised)
        if wrong < best:
            best, chosen, x, half_line = wrong, ways, tried_x, tried_y
            if best == 0:
                break
    if best == 1 << 30:
        return False, 0, 0, 0, 0
    raised = half_line & 1
    y = (half_line + 1 >> 1) - HALF
    low = _upper_and_sides(rows, y - start, x, raised, chosen, layout)
    high = raised << layout.raised_lsb | chosen << layout.outwards_lsb
    return True, low, high, x, y


@nb.njit(inline="always")
def _true_row(rows: Any, row: int) -> tuple[int, int]:
    """Return a row's ends; (1, 0) if it is empty."""
    return (rows[row, 0], rows[row, 1]) if 0 <= row < TRUE_ROWS else (1, 0)


@nb.njit
def _fewest_wrong(rows: Any, first_row: int, x: int, raised: int) -> tuple[int, int]:
    """Return the least number of wrong pixels about a middle, and the ways that give it.

    Bit 0 and bit 1 of the ways: first and last columns move outwards.
    """
    totals_00, totals_01, totals_10, totals_11 = 0, 0, 0, 0
    for k in range(ROWS - raised):
        first, last = _true_row(rows, first_row + k)
        true_first, true_last = _true_row(rows, first_row + BLOCK - 1 - raised - k)
        length = true_last - true_first + 1
        if first > last:
            in_first, in_last, out_first, out_last = length, 0, length, 0
        elif length > 0:
            a = true_first - (2 * x + BLOCK - 1 - last)  # above 0: inwards
            b = (2 * x + BLOCK - 1 - first) - true_last
            in_first, out_first = min(abs(a), abs(a - 1)), min(abs(a), abs(a + 1))
            in_last, out_last = min(abs(b), abs(b - 1)), min(abs(b), abs(b + 1))
        else:
            width = last - first + 1
            totals_00 += max(width - 2, 0)
            totals_01 += width - 1
            totals_10 += width - 1
            totals_11 += width
            continue
        totals_00 += in_first + in_last
        totals_01 += out_first + in_last
        totals_10 += in_first + out_last
        totals_11 += out_first + out_last
    wrong, ways = totals_00, 0
    if totals_01 < wrong:
        wrong, ways = totals_01, 1
    if totals_10 < wrong:
        wrong, ways = totals_10, 2
    if totals_11 < wrong:
        wrong, ways = totals_11, 3
    return wrong, ways


@nb.njit
def _upper_and_sides(rows: Any, first_row: int, x: int, raised: int, ways: int, layout: Any) -> int:
    """Return SCANS and SIDES of a symmetric word."""
    sides = 0
    for k in range(ROWS - raised):
        first, last = _true_row(rows, first_row + k)
        if first > last:
            continue
        true_first, true_last = _true_row(rows, first_row + BLOCK - 1 - raised - k)
        a = true_first - (2 * x + BLOCK - 1 - last)
        b = (2 * x + BLOCK - 1 - first) - true_last
        if true_first > true_last:
            a = b = 1  # it vanishes, or becomes as narrow as can be
        moved_first = a < 0 if ways & 1 else a > 0
        moved_last = b < 0 if ways & 2 else b > 0
        sides |= int(moved_first) << 2 * k | int(moved_last) << 2 * k + 1
    return _scans(rows, first_row, x) << 1 | sides << layout.side_lsb


@nb.njit
def _scans(rows: Any, first_row: int, x: int) -> int:
    """Return SCANS of four rows of an ellipse, in a block that begins at column ``x``."""
    scans = 0
    for k in range(ROWS):
        first, last = _true_row(rows, first_row + k)
        scans |= (1 if first > last else first - x | last - x << 3) << 6 * k
    return scans
