"""Large splats as fractions; each has the depth of the disc's plane at its position."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, ROWS

from .ellipse import CLOSED, extent, row_code, span
from .shape_table import EMPTY_SCANS
from .tile import first_column_of, first_line_of, first_part
from .write_words import put, quantised_depth

__all__ = [
    "STEEP",
    "covers_some",
    "cut",
    "encode_fractions",
    "fraction_of",
    "fraction_size",
    "lines_of",
    "row_of",
]

STEEP = 3.0 / 512.0
"""Share of the depth range from corner to corner beyond which ``exact`` halves a fraction, whose
pixels have one depth. Chosen by measured error against words and cycles (decision 0005)."""


@nb.njit(inline="always")
def fraction_size(change_x: float, change_y: float, steep: float) -> tuple[int, int]:
    """Return the most columns and lines that a splat's fractions may have.

    Parameters
    ----------
    change_x, change_y
        Change of the plane's depth from pixel to pixel, as shares of the depth range.
    steep
        The largest change within a whole fraction; above it, the fraction is half as large.
    """
    across, down = abs(change_x), abs(change_y)
    # NaN, from a frame without a depth range, is not steep.
    if (BLOCK - 1) * across + (ROWS - 1) * down > steep:
        if BLOCK * across >= ROWS * down:
            return BLOCK // 2, ROWS
        return BLOCK, ROWS // 2
    return BLOCK, ROWS


@nb.njit(inline="always")
def cut(first: int, last: int, most: int, change: float) -> tuple[int, int]:
    """Cut a splat into the fewest parts; return where the first begins, and their length.

    One part is cut short by ``first`` or ``last``: the one where the plane is further away. So a
    mirrored splat has mirrored fractions.

    Parameters
    ----------
    first, last
        Lines or columns of a splat; last < first if it has none.
    most
        Most lines or columns of a part.
    change
        Above 0 if the plane comes nearer from ``first`` to ``last``.
    """
    length = last + 1 - first
    parts = -(-length // most)
    if parts <= 1:
        return first, most
    each = -(-length // parts)
    parts = -(-length // each)
    return (first, each) if change < 0.0 else (last + 1 - parts * each, each)


@nb.njit(error_model="numpy")
def encode_fractions(
    column: float,
    line: float,
    square: float,
    form: Any,
    plane: Any,
    common: int,
    at: int,
    to: Any,
) -> int:
    """Write a splat's fractions; see :mod:`splatline.host.encode.write_words` for ``at``, ``to``.

    The splat is cut as in the whole image. Parts beside the tile are not looked at.

    Each fraction has the depth of the disc's plane at the mean position of its pixels. All
    fractions are about equally large, so that no pixel is far from that position.

    Parameters
    ----------
    column, line, square, form
        As for :func:`splatline.host.encode.ellipse.one_fraction`.
    plane
        The disc's plane: column and line of its centre, n'x and n'y over the focal length, the
        centre's distance along the view, the least distance and 1 over the depth range, the square
        of the radius over the distance, the distance of the near plane, and ``steep`` (see
        :func:`fraction_size`).
    common
        The words' bits that do not depend on the position.
    """
    width, z_lsb, largest = to.width, to.z_lsb, to.largest
    top, bottom = lines_of(line, square, form, plane, to.height)
    change = plane[4] * plane[6]
    columns, lines = fraction_size(plane[2] * change, plane[3] * change, plane[9])
    first_line, lines = cut(top, bottom, lines, plane[3])
    for uncut_line in range(
        first_part(first_line, lines, first_line_of(to)), min(bottom + 1, to.bottom), lines
    ):
        begin_line = max(uncut_line, top)
        rows = min(bottom + 1, uncut_line + lines) - begin_line
        left, right = width, -1
        for row in range(rows):
            first, last = row_of(begin_line + row, column, line, square, form, plane, width)
            if first <= last:
                left, right = min(left, first), max(right, last)
        first_column, wide = cut(left, right, columns, plane[2])
        for uncut in range(
            first_part(first_column, wide, first_column_of(to)), min(right + 1, to.right), wide
        ):
            begin, end = max(uncut, left), min(uncut + wide, right + 1)
            scans, x, y = fraction_of(
                begin, end, begin_line, rows, (column, line, square, form), plane, width
            )
            if scans != EMPTY_SCANS:
                # The ray meets the plane here, but not behind the eye.
                nearer = 1.0 + plane[2] * (x - plane[0]) + plane[3] * (y - plane[1])
                distance = plane[4] / nearer if nearer > 0.0 else math.inf
                z = quantised_depth((distance - plane[5]) * plane[6], largest)
                at = put(common | z << z_lsb, scans, begin, begin_line, at, to)
    return at


@nb.njit(inline="always", error_model="numpy")
def lines_of(line: float, square: float, form: Any, plane: Any, height: int) -> tuple[int, int]:
    """Return the first and last line of the image on which a splat may have pixels."""
    if plane[7] >= CLOSED:
        return 0, height - 1
    top, bottom = extent(line, form[0] / form[3] * square)
    return max(top, 0), min(bottom, height - 1)


@nb.njit(error_model="numpy")
def covers_some(
    column: float, line: float, square: float, form: Any, plane: Any, width: int, height: int
) -> bool:
    """Return whether a splat covers the centre of any pixel of the whole image.

    Parameters
    ----------
    column, line, square, form, plane
        As for :func:`encode_fractions`.
    width, height
        Of the image.
    """
    top, bottom = lines_of(line, square, form, plane, height)
    for row in range(top, bottom + 1):
        first, last = row_of(row, column, line, square, form, plane, width)
        if first <= last:
            return True
    return False


@nb.njit(error_model="numpy")
def fraction_of(
    begin: int, end: int, top: int, rows: int, ellipse: Any, plane: Any, width: int
) -> tuple[int, float, float]:
    """Return the rows of a splat's fraction, and the mean position of its pixels.

    Parameters
    ----------
    begin, end
        First column, and the column behind the last.
    top, rows
        First line, and their number.
    ellipse
        Column, line, square and form, as for :func:`encode_fractions`.
    plane, width
        The same, and the image's width.

    Returns
    -------
    scans
        ``EMPTY_SCANS`` if it has no pixel; then the position is 0.
    x, y
        In pixels.
    """
    column, line, square, form = ellipse
    scans, pixels, across, down = EMPTY_SCANS, 0, 0, 0
    for row in range(rows):
        first, last = row_of(top + row, column, line, square, form, plane, width)
        first, last = max(first, begin), min(last, end - 1)
        if first <= last:
            scans ^= (1 ^ row_code(first, last, True, begin)) << 6 * row
            count = last - first + 1
            pixels += count
            across += count * (first + last + 1)  # twice their centres' sum
            down += count * (2 * row + 1)
    if not pixels:
        return scans, 0.0, 0.0
    return scans, 0.5 * across / pixels, top + 0.5 * down / pixels


@nb.njit(error_model="numpy")
def row_of(
    row: int, column: float, line: float, square: float, form: Any, plane: Any, width: int
) -> tuple[int, int]:
    """Return the first and last pixel of a line of the image; first > last if there is none."""
    if plane[7] >= CLOSED:
        return _open_row(row, column, line, square, form, plane, width)
    inverse = 1.0 / form[0]
    dv = row + 0.5 - line
    middle = column - form[1] * inverse * dv - 0.5
    first, last, fills = span(form[0] * square, form[3] * dv * dv, middle, inverse, width)
    return (first, last) if fills else (width, -1)


@nb.njit(error_model="numpy")
def _open_row(
    row: int, column: float, line: float, square: float, form: Any, plane: Any, width: int
) -> tuple[int, int]:
    """Return a row of a disc that reaches behind the eye's plane; its image is no ellipse.

    The condition of ``in_perspective``, times the focal length squared and with (u, v) in pixels,
    is F(u) = a u^2 + 2 h u + k <= 0 on a row. A point beyond the near plane has
    0 < g = 1 + n'.(u, v) / focal <= z / near. F is above 0 where g is 0, so the row's pixels are an
    interval on one side of that position.
    """
    slope_x, slope_y = plane[2], plane[3]
    v = row + 0.5 - line
    ahead = 1.0 + slope_y * v  # g is this plus slope_x u
    a = form[0] - slope_x * slope_x * square
    h = form[1] * v - slope_x * square * ahead
    k = form[2] * v * v - square * ahead * ahead
    low, high = -column, width - column
    root = h * h - a * k
    if a > 0.0:
        if root < 0.0:
            return width, -1
        half = math.sqrt(root) / a
        low, high = max(low, -h / a - half), min(high, -h / a + half)
    elif a < 0.0 and root >= 0.0:
        half = math.sqrt(root) / -a
        if slope_x > 0.0:
            low = max(low, -h / a + half)
        else:
            high = min(high, -h / a - half)
    # Between the eye's plane and the near one.
    nearest = plane[4] / plane[8]
    if slope_x != 0.0:
        zero, near = -ahead / slope_x, (nearest - ahead) / slope_x
        low, high = max(low, min(zero, near)), min(high, max(zero, near))
    elif not 0.0 < ahead <= nearest:
        return width, -1
    if not low <= high:
        return width, -1
    first = math.ceil(max(column + low - 0.5, 0.0))
    last = math.floor(min(column + high - 0.5, width - 1.0))
    return (first, last) if first <= last else (width, -1)
