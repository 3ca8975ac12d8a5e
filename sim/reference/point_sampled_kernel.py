"""The compiled loops of :mod:`splatline.sim.reference.point_sampled`: depth test and fractions."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from splatline.contract.config import BLOCK, ROWS
from splatline.contract.plane import SHIFTS, SUM_FRACTION, Z_FRACTION
from splatline.host.compiled_cache import cached_njit
from splatline.host.encode.large_splats import STEEP, cut, fraction_size

from .footprints import meet, plane_depth

__all__ = ["DEPTHS", "draw_bands", "round_slopes"]

DEPTHS = {"pixel": 0, "fraction": 1, "splat": 2, "plane": 3}
PER_PIXEL, PER_FRACTION, PER_PLANE = DEPTHS["pixel"], DEPTHS["fraction"], DEPTHS["plane"]

SHIFT = np.array(SHIFTS, np.int64)

BAND = 16
"""Lines of the image in a band."""


@cached_njit()
def _sort_into_bands(splats: Any, bands: int) -> tuple[Any, Any]:
    """Return the splats of each band, in order: ``members[starts[b]:starts[b + 1]]``."""
    starts = np.zeros(bands + 1, np.int64)
    for i in range(len(splats)):
        if splats[i].left <= splats[i].right:
            for band in range(splats[i].top // BAND, splats[i].bottom // BAND + 1):
                starts[band + 1] += 1
    starts = np.cumsum(starts)
    fill = starts.copy()
    members = np.empty(starts[-1], np.int64)
    for i in range(len(splats)):
        if splats[i].left <= splats[i].right:
            for band in range(splats[i].top // BAND, splats[i].bottom // BAND + 1):
                members[fill[band]] = i
                fill[band] += 1
    return starts, members


def draw_bands(
    splats: Any, discs: Any, camera: Any, coding: Any, depth: int, codes: Any, seen: Any
) -> None:
    """Draw splats with a depth test.

    Parameters
    ----------
    splats, discs, camera
        As for ``place_splats``.
    coding
        Largest depth code (0: not quantised), whether codes are steps of 1 / z, the value of code
        0, the span of the codes, and the largest slope of a plane (0: planes are not drawn).
    depth
        A value of ``DEPTHS``.
    codes
        Depth codes so far, inf where nothing is drawn: shape (height, width), float64; updated.
    seen
        Index of the splat that is seen: shape (height, width), int64; updated.
    """
    starts, members = _sort_into_bands(splats, -(-len(seen) // BAND))
    _draw_bands(starts, members, splats, discs, camera, coding, depth, codes, seen)


@cached_njit(parallel=True, error_model="numpy")
def _draw_bands(
    starts: Any,
    members: Any,
    splats: Any,
    discs: Any,
    camera: Any,
    coding: Any,
    depth: int,
    codes: Any,
    seen: Any,
) -> None:
    """Draw the bands in parallel."""
    centres, normals, _, radii = discs
    for band in numba.prange(len(starts) - 1):
        lines = (BAND * band, min(BAND * band + BAND, len(seen)))
        for member in range(starts[band], starts[band + 1]):
            i = members[member]
            disc = (centres[i], normals[i], radii[i])
            if depth in (PER_FRACTION, PER_PLANE):
                _draw_fractions(i, splats[i], disc, camera, coding, lines, codes, seen)
            else:
                _draw(i, splats[i], disc, camera, coding, depth, lines, codes, seen)


@numba.njit(error_model="numpy")
def _code(z: float, coding: Any) -> float:
    """Return the code of a depth, or the depth itself if it is not quantised."""
    largest, reciprocal, low, span, _ = coding
    if largest == 0:
        return z
    share = ((1.0 / z if reciprocal else z) - low) / span
    return math.floor(min(max(share, 0.0), 1.0) * largest + 0.5)


@numba.njit(error_model="numpy")
def _draw(
    i: int,
    splat: Any,
    disc: Any,
    camera: Any,
    coding: Any,
    depth: int,
    lines: Any,
    codes: Any,
    seen: Any,
) -> None:
    """Draw a splat's pixels, each at its own depth or all at the centre's depth."""
    centre, normal, radius = disc
    code = _code(centre[2], coding)
    for line in range(max(splat.top, lines[0]), min(splat.bottom + 1, lines[1])):
        for column in range(splat.left, splat.right + 1):
            z = meet(line, column, splat, centre, normal, radius, camera)
            if z < np.inf:
                if depth == PER_PIXEL:
                    code = _code(z, coding)
                if code < codes[line, column]:
                    codes[line, column] = code
                    seen[line, column] = i


@numba.njit(error_model="numpy")
def _draw_fractions(
    i: int, splat: Any, disc: Any, camera: Any, coding: Any, lines: Any, codes: Any, seen: Any
) -> None:
    """Draw a splat by the host's fractions, each at the depth of its pixels' mean position.

    With planes a splat of up to 8 x 8 pixels is one part, and no part is halved.
    """
    centre, has_planes = disc[0], coding[4] > 0
    top, bottom = splat.top, min(splat.bottom, codes.shape[0] - 1)
    left, right = _columns(top, bottom, splat, disc, camera)
    wide, high = BLOCK, ROWS
    if bottom - top >= ROWS or right - left >= BLOCK:
        change = centre[2] / (camera[0] * coding[3])
        steep = math.inf if has_planes else STEEP
        wide, high = fraction_size(change * splat.slope_x, change * splat.slope_y, steep)
        if has_planes and bottom - top < BLOCK and right - left < BLOCK:
            high = BLOCK
    first_line, high = cut(top, bottom, high, splat.slope_y)
    for line in range(first_line, bottom + 1, high):
        rows = max(line, top), min(line + high - 1, bottom)
        if rows[1] < lines[0] or rows[0] >= lines[1]:
            continue
        left, right = _columns(rows[0], rows[1], splat, disc, camera)
        first_column, each = cut(left, right, wide, splat.slope_x)
        for column in range(first_column, right + 1, each):
            block = rows[0], rows[1], max(column, left), min(column + each - 1, right)
            _draw_fraction(i, block, splat, disc, camera, coding, lines, codes, seen)


@numba.njit(error_model="numpy")
def _columns(top: int, bottom: int, splat: Any, disc: Any, camera: Any) -> tuple[int, int]:
    """Return the first and last column of a splat between two lines; first > last if none."""
    centre, normal, radius = disc
    first, last = splat.right + 1, splat.left - 1
    for line in range(top, bottom + 1):
        for column in range(splat.left, splat.right + 1):
            if meet(line, column, splat, centre, normal, radius, camera) < np.inf:
                first, last = min(first, column), max(last, column)
    return first, last


@numba.njit(error_model="numpy")
def _draw_fraction(
    i: int,
    block: Any,
    splat: Any,
    disc: Any,
    camera: Any,
    coding: Any,
    lines: Any,
    codes: Any,
    seen: Any,
) -> None:
    """Draw a splat's pixels inside a block, given by its first and last line and column."""
    centre, normal, radius = disc
    pixels, across, down = 0, 0.0, 0.0
    for line in range(block[0], block[1] + 1):
        for column in range(block[2], block[3] + 1):
            if meet(line, column, splat, centre, normal, radius, camera) < np.inf:
                pixels += 1
                across += column + 0.5
                down += line + 0.5
    if pixels == 0:
        return
    x = across / pixels * splat.scale + splat.across
    y = down / pixels * splat.scale + splat.down
    code = _code(plane_depth(x, y, centre, normal, camera), coding)
    slope_x, slope_y, first = 0.0, 0.0, code
    if coding[4]:
        levels = coding[0] / coding[3]
        half = 0.5 * splat.scale
        before = plane_depth(x - half, y, centre, normal, camera)
        after = plane_depth(x + half, y, centre, normal, camera)
        above = plane_depth(x, y - half, centre, normal, camera)
        below = plane_depth(x, y + half, centre, normal, camera)
        slope_x, slope_y = round_slopes(
            (after - before) * levels, (below - above) * levels, coding[4]
        )
        middle = (plane_depth(x, y, centre, normal, camera) - coding[2]) * levels
        middle += slope_x * (block[2] + 0.5 - across / pixels)
        middle += slope_y * (block[0] + 0.5 - down / pixels)
        first = math.floor((middle + 0.5) * (1 << Z_FRACTION) + 0.5) / (1 << Z_FRACTION)
    for line in range(max(block[0], lines[0]), min(block[1] + 1, lines[1])):
        for column in range(block[2], block[3] + 1):
            if coding[4]:
                total = first + slope_x * (column - block[2]) + slope_y * (line - block[0])
                code = min(max(math.floor(total), 0.0), float(coding[0]))
            if code < codes[line, column] and (
                meet(line, column, splat, centre, normal, radius, camera) < np.inf
            ):
                codes[line, column] = code
                seen[line, column] = i


@numba.njit(error_model="numpy")
def round_slopes(slope_x: float, slope_y: float, most: int) -> tuple[float, float]:
    """Return two slopes in levels a pixel as a plane word holds them.

    ``most`` is the largest slope before the shift, whose finest step is a quarter of a level.
    """
    unit = float(1 << SUM_FRACTION)
    steepest, scale = unit * max(abs(slope_x), abs(slope_y)), 0
    while scale < len(SHIFT) - 1 and not steepest < (most + 0.5) * (1 << SHIFT[scale]):
        scale += 1
    step = (1 << SHIFT[scale]) / unit
    x = min(max(math.floor(slope_x / step + 0.5), float(-most)), float(most))
    y = min(max(math.floor(slope_y / step + 0.5), float(-most)), float(most))
    return x * step, y * step
