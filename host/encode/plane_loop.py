"""The compiled loop over splats for an engine with planes: one word for what fits a block."""

from __future__ import annotations

import math
from typing import Any

import numba as nb
import numpy as np

from splatline.contract.config import BLOCK, ROWS
from splatline.host.compiled_cache import cached_njit
from splatline.host.visibility.footprint import FLAT, SMALLEST, conic, is_tiny
from splatline.host.visibility.occlusion import is_hidden
from splatline.host.visibility.splats import COLUMN, DEPTH, DIAMETER, LINE, LOOK, SLOPE_X, SLOPE_Y
from splatline.host.visibility.view import LARGEST

from .ellipse import CLOSED, in_perspective, one_fraction
from .large_splats import covers_some, cut, fraction_of, lines_of, row_of
from .plane_block import TRUE_ROWS, encode_block
from .plane_words import plane_bits, put_plane
from .shape_table import EMPTY_SCANS
from .splat_loop import DRAWN, HIDDEN, own_pixel
from .tile import first_column_of, first_line_of, first_part
from .write_words import ONE_PIXEL, quantised_depth

__all__ = ["encode_plane_splats"]

SLACK = 4.0
"""Levels by which rounding may bring a pixel nearer where slopes have their finest scale: half a
step over 14 pixels, 1.75, half a level and half a unit of Z, cut off."""


@cached_njit(parallel=True, error_model="numpy")
def encode_plane_splats(
    wave: Any, source: Any, fixed: Any, layout: Any, to: Any, occluders: Any, slots: Any
) -> None:
    """Encode chunks as plane words, each into its own slots, and count their words on each line.

    Parameters
    ----------
    wave, source, fixed, occluders, slots
        As for :func:`splatline.host.encode.splat_loop.encode_splats`.
    layout
        See :class:`splatline.host.encode.plane_words.Layout`.
    to
        Where words go; see :class:`splatline.host.encode.tile.Target`.
    """
    floats, bits, doubles, begins, ends = source
    lines, width, height = to.lines, to.width, to.height
    origin = to.origin_x, to.origin_y
    skip_hidden, bound, coarse = occluders
    starts, stops, counts, elements, hidden, marks = slots
    marked = len(marks) > 0
    inverse_focal, low, inverse_span = fixed.inverse_focal, fixed.low, fixed.inverse_span
    nearest_pixel, middle_x, middle_y = fixed.nearest_pixel, fixed.middle_x, fixed.middle_y
    for number in nb.prange(len(wave)):
        chunk = wave[number]
        at = starts[chunk]
        drawn, behind = 0, 0
        rows = np.empty((TRUE_ROWS, 2), np.int64)
        for i in range(begins[chunk], ends[chunk]):
            before = at
            column, line = float(floats[i, COLUMN]), float(floats[i, LINE])
            slope_x, slope_y = float(floats[i, SLOPE_X]), float(floats[i, SLOPE_Y])
            distance = doubles[i, DEPTH]
            a = (column - middle_x) * inverse_focal
            b = (line - middle_y) * inverse_focal
            form = conic(a, b, slope_x, slope_y)
            radius = min(max(0.5 * float(floats[i, DIAMETER]), SMALLEST), LARGEST)
            square = radius * radius
            in_depth = square * inverse_focal > FLAT
            share = radius * inverse_focal
            plane = (
                column, line, slope_x * inverse_focal, slope_y * inverse_focal,
                distance, low, inverse_span * layout.largest, share * share, fixed.near,
            )  # fmt: skip
            disc = column, line, tangent(plane, column, line), radius
            if (
                skip_hidden
                and not in_depth
                and _is_hidden(disc, a, b, layout, origin, bound, coarse)
            ):
                behind += 1
                if marked:
                    marks[i] = HIDDEN
                continue
            centre_x, centre_y = column, line
            if in_depth:
                right, down, square, form_a, form_b, form_c, determinant = in_perspective(
                    form, slope_x, slope_y, square, inverse_focal
                )
                form = form_a, form_b, form_c, determinant
                centre_x, centre_y = column + right, line + down
            found, x, top, scans = 2, 0, 0, 0
            if is_tiny(radius, a, b, inverse_focal):
                found, x, top = own_pixel(column, line, square, form, width, height)
                scans = ONE_PIXEL
            elif share < 0.5:
                found, x, top, scans = one_fraction(centre_x, centre_y, square, form, width, height)
            look = np.int64(bits[i, LOOK]) << layout.look_lsb
            ellipse = centre_x, centre_y, square, form
            if found == 2:
                at = _encode_larger(ellipse, plane, look, rows, layout, at, to)
            uncovered = found == 0 or (
                found == 2
                and at == before
                and nearest_pixel
                and not _covers_some(ellipse, plane, rows, layout, width, height)
            )
            if uncovered:
                x, top, scans = math.floor(column), math.floor(line), ONE_PIXEL
                found = int(nearest_pixel and 0 <= x < width and 0 <= top < height)
            if found == 1:
                # The splat's centre may lie outside the image, far from the part inside.
                u = min(max(centre_x, float(x)), float(x + BLOCK))
                v = min(max(centre_y, float(top)), float(top + ROWS))
                depth, change_x, change_y = tangent(plane, u, v)
                if uncovered:  # the disc does not reach its pixel's centre, its plane may be far
                    change_x = change_y = 0.0
                right, down = u - x - 0.5, v - top - 0.5
                high = plane_bits(depth, change_x, change_y, right, down, layout)
                at = put_plane(look | scans << 1 | 1, high, x, top + ROWS, at, to, layout)
            drawn += at > before
            if marked and at > before:
                marks[i] = DRAWN
            for word in range(before, at):
                counts[chunk, lines[word]] += 1
        stops[chunk] = at
        elements[chunk] = drawn
        hidden[chunk] = behind


@nb.njit(inline="always")
def tangent(plane: Any, column: float, line: float) -> tuple[float, float, float]:
    """Return a disc's depth where a ray meets it, and the change of depth there.

    Parameters
    ----------
    plane
        As for :func:`splatline.host.encode.large_splats.encode_fractions`, without ``steep``; the
        seventh is in levels of depth.
    column, line
        The ray's, in pixels.

    Returns
    -------
    depth
        In levels; infinite if the ray meets the plane behind the eye.
    change_x, change_y
        In levels from column to column and from line to line.
    """
    nearer = 1.0 + plane[2] * (column - plane[0]) + plane[3] * (line - plane[1])
    if not nearer > 0.0:
        return math.inf, 0.0, 0.0
    distance = plane[4] / nearer
    steep = -distance / nearer * plane[6]
    return (distance - plane[5]) * plane[6], steep * plane[2], steep * plane[3]


@nb.njit(error_model="numpy")
def _is_hidden(
    disc: Any, a: float, b: float, layout: Any, origin: Any, bound: Any, coarse: Any
) -> bool:
    """Return whether a splat is hidden, whatever its word will be.

    Its least depth is that of a plane whose slopes are rounded outwards, at a corner of its
    rectangle. From scale to scale a slope's step grows fourfold at most, so the steeper slope has
    at least a quarter of the largest value, and half a step is 2 / (largest + 1 / 2) of it. A Z
    that is cut off at the largest value moves the plane nearer, but not so far that the block's
    first pixel lies before the largest depth.

    Parameters
    ----------
    disc
        Column and line of its centre, its plane and its radius in pixels.
    a, b
        x / z and y / z of its centre.
    origin
        Column and line at which the pyramid begins.
    bound, coarse
        The pyramid.
    """
    column, line, plane, radius = disc
    depth, change_x, change_y = plane
    wide = radius * (1.0 + min(abs(a), 0.5 * a * a)) + 0.01
    high = radius * (1.0 + min(abs(b), 0.5 * b * b)) + 0.01
    largest = layout.largest
    rounding = 2.0 / (layout.slope_most + 0.5) * max(abs(change_x), abs(change_y))
    across, down = abs(change_x) + rounding, abs(change_y) + rounding
    nearer = depth - across * wide - down * high
    cut_off = largest - (BLOCK - 1) * (across + down)
    z = quantised_depth((min(nearer, cut_off) - SLACK) / largest, largest)
    return is_hidden(column - origin[0], line - origin[1], wide, high, z, bound, coarse)


@nb.njit(error_model="numpy")
def _covers_some(ellipse: Any, plane: Any, rows: Any, layout: Any, width: int, height: int) -> bool:
    """Return whether :func:`_encode_larger` has words for a splat, if the tile is the image."""
    centre_x, centre_y, square, form = ellipse
    if plane[7] < CLOSED:
        found, _, _, x, y = encode_block(centre_x, centre_y, square, form, rows, layout)
        if found and x >= 0 and y >= -ROWS:
            return x < width and y < height
    return covers_some(centre_x, centre_y, square, form, plane, width, height)


@nb.njit(error_model="numpy")
def _encode_larger(
    ellipse: Any, plane: Any, look: int, rows: Any, layout: Any, at: int, to: Any
) -> int:
    """Write a splat that is not one fraction: one symmetric word, or fractions; return the slot.

    Parameters
    ----------
    ellipse
        Column and line of its centre, the square of its radius, its form.
    plane
        See :func:`tangent`.
    """
    centre_x, centre_y, square, form = ellipse
    width, height = to.width, to.height
    if plane[7] < CLOSED:
        found, low, high, x, y = encode_block(centre_x, centre_y, square, form, rows, layout)
        if found and x >= 0 and y >= -ROWS:
            if x >= width or y >= height:
                return at
            high |= plane_bits(
                *tangent(plane, centre_x, centre_y), centre_x - x - 0.5, centre_y - y - 0.5, layout
            )
            return put_plane(look | low, high, x, y + ROWS, at, to, layout)
    return _encode_fractions(centre_x, centre_y, square, form, plane, look, layout, at, to)


@nb.njit(error_model="numpy")
def _encode_fractions(
    column: float,
    line: float,
    square: float,
    form: Any,
    plane: Any,
    look: int,
    layout: Any,
    at: int,
    to: Any,
) -> int:
    """Write a splat's fractions, each with the tangent plane at its pixels' mean position.

    Parameters
    ----------
    column, line, square, form
        As for :func:`splatline.host.encode.ellipse.one_fraction`.
    plane
        See :func:`tangent`.
    """
    width = to.width
    top, bottom = lines_of(line, square, form, plane, to.height)
    first_line, lines = cut(top, bottom, ROWS, plane[3])
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
        first_column, wide = cut(left, right, BLOCK, plane[2])
        for uncut in range(
            first_part(first_column, wide, first_column_of(to)), min(right + 1, to.right), wide
        ):
            begin, end = max(uncut, left), min(uncut + wide, right + 1)
            scans, x, y = fraction_of(
                begin, end, begin_line, rows, (column, line, square, form), plane, width
            )
            if scans != EMPTY_SCANS:
                high = plane_bits(
                    *tangent(plane, x, y), x - begin - 0.5, y - begin_line - 0.5, layout
                )
                low = look | scans << 1 | 1
                at = put_plane(low, high, begin, begin_line + ROWS, at, to, layout)
    return at
