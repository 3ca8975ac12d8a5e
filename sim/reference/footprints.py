"""The footprints of point-sampled splats: their positions, bounds and intersections with rays.

Rounding moves and scales a footprint as a whole. A splat therefore maps a pixel's column to the
position ``scale (column + 0.5) + across`` of the true footprint, and likewise its line.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from splatline.contract.config import BLOCK
from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.normal_levels import LEVELS, quantise_slopes

from .reference_kernel import bound_disc, bound_part

__all__ = ["PLACES", "SIZES", "SPLAT", "meet", "place_splats", "plane_depth"]

PLACES = {"true": 0, "quarter": 4, "whole": 1}
"""Positions of a centre per pixel; 0: not rounded."""

SIZES = {"true": 0, "half": 2, "whole": 1}
"""Diameters per pixel; 0: not rounded."""

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

SLACK = 1e-6
"""Pixels by which bounding boxes are widened, to allow for rounding."""

STEEPEST = -1e-6
"""Largest product of a normal with its ray (z = 1) for slopes; larger ones are clamped to it."""

FAR = 1e9
"""A position in pixels beyond any image."""


@cached_njit(parallel=True, error_model="numpy")
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
        level_x, level_y = quantise_slopes(splat.slope_x, splat.slope_y, LEVELS)
        splat.slope_x, splat.slope_y = slopes[level_x], slopes[level_y]
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
            if meet(line, column, splat, centre, normal, radius, camera) < np.inf:
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
def meet(
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
    t = plane_depth(x, y, centre, normal, camera)
    focal, near, _, _, middle_x, middle_y = camera
    if not near <= t < np.inf:
        return np.inf
    dx = t * (x - middle_x) / focal - centre[0]
    dy = t * (y - middle_y) / focal - centre[1]
    dz = t - centre[2]
    return t if dx * dx + dy * dy + dz * dz <= radius * radius else np.inf


@numba.njit(error_model="numpy")
def plane_depth(x: float, y: float, centre: Any, normal: Any, camera: Any) -> float:
    """Return the depth of a disc's plane at a position of the image."""
    focal, _, _, _, middle_x, middle_y = camera
    pull = normal[0] * centre[0] + normal[1] * centre[1] + normal[2] * centre[2]
    a, b = (x - middle_x) / focal, (y - middle_y) / focal
    return pull / (normal[0] * a + normal[1] * b + normal[2])
