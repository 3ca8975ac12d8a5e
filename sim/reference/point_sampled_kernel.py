"""The compiled loops of :mod:`splatline.sim.reference.point_sampled`: footprints and depth test.

Rounding moves and scales a footprint as a whole. A splat therefore maps a pixel's column to the
position ``scale (column + 0.5) + across`` of the true footprint, and likewise its line.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from splatline.contract.config import BLOCK, ROWS
from splatline.host.encode.large_splats import STEEP, cut, fraction_size
from splatline.host.encode.shape_table import LEVELS, quantise

from .reference_kernel import bound_disc, bound_part

__all__ = ["DEPTHS", "PLACES", "SIZES", "SPLAT", "draw_bands", "place_splats"]

PLACES = {"true": 0, "quarter": 4, "whole": 1}
"""Positions of a centre per pixel; 0: not rounded."""

SIZES = {"true": 0, "half": 2, "whole": 1}
"""Diameters per pixel; 0: not rounded."""

DEPTHS = {"pixel": 0, "fraction": 1, "splat": 2}
PER_PIXEL, PER_FRACTION = DEPTHS["pixel"], DEPTHS["fraction"]

DISC, ELLIPSE, PIXEL, PAIR = range(4)
"""Footprints: disc in perspective, the paper's ellipse, one pixel, pixel and its half rotation."""

SPLAT = np.dtype(
    [
        ("kind", np.int64),
        ("left", np.int64),  # bounding box in pixels, inclusive, within the image
        ("right", np.int64),
        ("top", np.int64),
        ("bottom", np.int64),
        ("scale", np.float64),
        ("across", np.float64),
        ("down", np.float64),
        ("column", np.float64),  # true centre on the image
        ("line", np.float64),
        (
            "slope_x",
            np.float64,
        ),  # n'; of a PAIR the column on the upper (x) and on the lower (y) line
        ("slope_y", np.float64),
        ("square", np.float64),  # true radius in pixels, squared
    ]
)

BAND = 16
"""Lines of the image in a band."""

SLACK = 1e-6
"""Pixels by which bounding boxes are widened, to allow for rounding."""

STEEPEST = -1e-6
"""Largest product of a normal with its ray (z = 1) for slopes; larger ones are clamped to it."""

FAR = 1e9
"""A position in pixels beyond any image."""


@numba.njit(cache=True, parallel=True, error_model="numpy")
def place_splats(discs: Any, camera: Any, rounding: Any, slopes: Any, splats: Any) -> None:
    """Fill in ``splats``; a splat that is not drawn gets left > right.

    Parameters
    ----------
    discs
        Centres and normals in camera axes, shape (n, 3), which discs face the eye, and radii.
    camera
        Focal length in pixels, near distance, width, height, and column and line of the image's
        middle.
    rounding
        Positions per pixel, diameters per pixel, whether diameters are rounded up, and whether
        empty splats get a pixel.
    slopes
        Slope of each level of n'; empty: normals are not quantised.
    splats
        Shape (n,), of type ``SPLAT``.
    """
    for i in numba.prange(len(splats)):
        _place(i, discs, camera, rounding, slopes, splats[i])


@numba.njit(error_model="numpy")
def _place(i: int, discs: Any, camera: Any, rounding: Any, slopes: Any, splat: Any) -> None:
    """Fill in one splat."""
    centres, normals, facing, radii = discs
    focal, near, width, height, middle_x, middle_y = camera
    places, sizes, _, never_empty = rounding
    splat.left, splat.right = 0, -1
    centre, normal, radius = centres[i], normals[i], radii[i]
    reach = radius * math.sqrt(max(0.0, 1.0 - normal[2] ** 2))
    if not facing[i] or radius == 0.0 or centre[2] + reach < near:
        return
    splat.kind = DISC
    splat.scale, splat.across, splat.down = 1.0, 0.0, 0.0
    size = 0.0
    if centre[2] >= near:
        splat.column = middle_x + focal * centre[0] / centre[2]
        splat.line = middle_y + focal * centre[1] / centre[2]
        size = _round_splat(radius * focal / centre[2], rounding, splat)
        along = normal[0] * centre[0] + normal[1] * centre[1] + normal[2] * centre[2]
        towards = min(along / centre[2], STEEPEST)
        splat.slope_x, splat.slope_y = normal[0] / towards, normal[1] / towards
    elif places or sizes or never_empty or len(slopes):  # the centre is before the near plane
        return
    if len(slopes):
        splat.kind = ELLIPSE
        splat.slope_x = slopes[quantise(-splat.slope_x, -1.0, LEVELS)]
        splat.slope_y = slopes[quantise(-splat.slope_y, -1.0, LEVELS)]
        half = math.sqrt(splat.square)
        low_x, high_x = splat.column - half, splat.column + half
        low_y, high_y = splat.line - half, splat.line + half
    else:
        if centre[2] - reach < near:
            low_x, high_x = bound_part(centre, normal, radius, 0, near)
            low_y, high_y = bound_part(centre, normal, radius, 1, near)
        else:
            low_x, high_x = bound_disc(centre, normal, radius, 0)
            low_y, high_y = bound_disc(centre, normal, radius, 1)
        low_x, high_x = middle_x + focal * low_x, middle_x + focal * high_x
        low_y, high_y = middle_y + focal * low_y, middle_y + focal * high_y

    splat.left, splat.right = _pixels(low_x, high_x, splat.scale, splat.across)
    splat.top, splat.bottom = _pixels(low_y, high_y, splat.scale, splat.down)
    if never_empty and _is_empty(splat, centre, normal, radius, camera):
        _draw_least(places, size, splat)
    splat.left, splat.right = max(splat.left, 0), min(splat.right, width - 1)
    splat.top, splat.bottom = max(splat.top, 0), min(splat.bottom, height - 1)
    if splat.top > splat.bottom:
        splat.left, splat.right = 0, -1


@numba.njit(error_model="numpy")
def _round_splat(radius: float, rounding: Any, splat: Any) -> float:
    """Round a splat's position and size; return the rounded diameter."""
    places, sizes, size_up, _ = rounding
    diameter = 2.0 * radius
    splat.square = radius * radius
    if sizes:
        steps = math.ceil(sizes * diameter) if size_up else math.floor(sizes * diameter + 0.5)
        diameter = max(steps, 1.0) / sizes
    splat.scale = 2.0 * radius / diameter
    column, line = splat.column, splat.line
    if places:
        column = math.floor(places * column + 0.5) / places
        line = math.floor(places * line + 0.5) / places
    # Both are 0 if nothing is rounded.
    splat.across = splat.column - column * splat.scale
    splat.down = splat.line - line * splat.scale
    return diameter


@numba.njit(error_model="numpy")
def _pixels(low: float, high: float, scale: float, shift: float) -> tuple[int, int]:
    """Return the first and last pixel whose centre maps to a position between two bounds."""
    first, last = (low - shift) / scale - 0.5 - SLACK, (high - shift) / scale - 0.5 + SLACK
    return math.ceil(min(max(first, -FAR), FAR)), math.floor(min(max(last, -FAR), FAR))


@numba.njit(error_model="numpy")
def _is_empty(splat: Any, centre: Any, normal: Any, radius: float, camera: Any) -> bool:
    """Return whether a footprint covers no pixel's centre, inside or outside the image."""
    # A larger footprint is assumed to cover one, even if it is seen edge on.
    if splat.bottom - splat.top > 4 * BLOCK or splat.right - splat.left > 4 * BLOCK:
        return False
    for line in range(splat.top, splat.bottom + 1):
        for column in range(splat.left, splat.right + 1):
            if _meet(line, column, splat, centre, normal, radius, camera) < np.inf:
                return False
    return True


@numba.njit(error_model="numpy")
def _draw_least(places: int, size: float, splat: Any) -> None:
    """Give an empty splat the least footprint: one pixel, or a pixel and its half rotation."""
    if places != 1 or size <= 1.0:
        splat.kind = PIXEL
        splat.left = splat.right = math.floor(splat.column)
        splat.top = splat.bottom = math.floor(splat.line)
        return
    splat.kind = PAIR
    column, line = math.floor(splat.column + 0.5), math.floor(splat.line + 0.5)
    # The column of least distance in the ellipse's metric, on the line above the corner.
    x, y = splat.slope_x, splat.slope_y
    aside = math.floor(0.5 * x * y / (1.0 + x * x))
    upper, lower = column + aside, column - 1 - aside
    splat.slope_x, splat.slope_y = upper, lower
    splat.left, splat.right = min(upper, lower), max(upper, lower)
    splat.top, splat.bottom = line - 1, line


@numba.njit(error_model="numpy")
def _meet(
    line: int, column: int, splat: Any, centre: Any, normal: Any, radius: float, camera: Any
) -> float:
    """Return the depth at which a pixel's ray hits a splat, or inf; the pixel is in its box."""
    if splat.kind == PIXEL:
        return centre[2]
    x = (column + 0.5) * splat.scale + splat.across
    y = (line + 0.5) * splat.scale + splat.down
    if splat.kind == DISC:
        return _meet_disc(x, y, centre, normal, radius, camera)
    if splat.kind == ELLIPSE:
        u, v = x - splat.column, y - splat.line
        w = splat.slope_x * u + splat.slope_y * v
        if u * u + v * v + w * w <= splat.square:
            return centre[2] * (1.0 - w / camera[0])
        return np.inf
    upper = line < math.floor(splat.line + 0.5)
    return centre[2] if column == (splat.slope_x if upper else splat.slope_y) else np.inf


@numba.njit(error_model="numpy")
def _meet_disc(x: float, y: float, centre: Any, normal: Any, radius: float, camera: Any) -> float:
    """Return the depth at which the ray through a position of the image hits a disc, or inf."""
    t = _plane_depth(x, y, centre, normal, camera)
    focal, near, _, _, middle_x, middle_y = camera
    if not near <= t < np.inf:
        return np.inf
    dx = t * (x - middle_x) / focal - centre[0]
    dy = t * (y - middle_y) / focal - centre[1]
    dz = t - centre[2]
    return t if dx * dx + dy * dy + dz * dz <= radius * radius else np.inf


@numba.njit(error_model="numpy")
def _plane_depth(x: float, y: float, centre: Any, normal: Any, camera: Any) -> float:
    """Return the depth of a disc's plane at a position of the image."""
    focal, _, _, _, middle_x, middle_y = camera
    pull = normal[0] * centre[0] + normal[1] * centre[1] + normal[2] * centre[2]
    a, b = (x - middle_x) / focal, (y - middle_y) / focal
    return pull / (normal[0] * a + normal[1] * b + normal[2])


@numba.njit(cache=True)
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
        Largest depth code (0: not quantised), whether codes are steps of 1 / z, the value of code 0
        and the span of the codes.
    depth
        A value of ``DEPTHS``.
    codes
        Depth codes so far, inf where nothing is drawn: shape (height, width), float64; updated.
    seen
        Index of the splat that is seen: shape (height, width), int64; updated.
    """
    starts, members = _sort_into_bands(splats, -(-len(seen) // BAND))
    _draw_bands(starts, members, splats, discs, camera, coding, depth, codes, seen)


@numba.njit(cache=True, parallel=True, error_model="numpy")
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
            if depth == PER_FRACTION:
                _draw_fractions(i, splats[i], disc, camera, coding, lines, codes, seen)
            else:
                _draw(i, splats[i], disc, camera, coding, depth, lines, codes, seen)


@numba.njit(error_model="numpy")
def _code(z: float, coding: Any) -> float:
    """Return the code of a depth, or the depth itself if it is not quantised."""
    largest, reciprocal, low, span = coding
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
            z = _meet(line, column, splat, centre, normal, radius, camera)
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
    """Draw a splat by the host's fractions, each at the depth of its pixels' mean position."""
    centre = disc[0]
    top, bottom = splat.top, min(splat.bottom, codes.shape[0] - 1)
    left, right = _columns(top, bottom, splat, disc, camera)
    wide, high = BLOCK, ROWS
    if bottom - top >= ROWS or right - left >= BLOCK:
        change = centre[2] / (camera[0] * coding[3])
        wide, high = fraction_size(change * splat.slope_x, change * splat.slope_y, STEEP)
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
            if _meet(line, column, splat, centre, normal, radius, camera) < np.inf:
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
            if _meet(line, column, splat, centre, normal, radius, camera) < np.inf:
                pixels += 1
                across += column + 0.5
                down += line + 0.5
    if pixels == 0:
        return
    x = across / pixels * splat.scale + splat.across
    y = down / pixels * splat.scale + splat.down
    code = _code(_plane_depth(x, y, centre, normal, camera), coding)
    for line in range(max(block[0], lines[0]), min(block[1] + 1, lines[1])):
        for column in range(block[2], block[3] + 1):
            if code < codes[line, column] and (
                _meet(line, column, splat, centre, normal, radius, camera) < np.inf
            ):
                codes[line, column] = code
                seen[line, column] = i
