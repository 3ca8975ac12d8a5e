"""The compiled loops of the exact reference: bounds of discs, and the samples that hit them."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from splatline.host.compiled_cache import cached_njit

__all__ = ["BAND", "bound_disc", "bound_discs", "bound_part", "draw_bands", "sort_into_bands"]

BAND = 16
"""Lines of the image in a band; the samples of a band fit a core's cache."""


@cached_njit()
def bound_discs(
    centres: Any,
    normals: Any,
    facing: Any,
    radii: Any,
    optics: tuple[float, float, float, float],
    size: tuple[int, int],
    boxes: Any,
) -> None:
    """Set the bounding box of each disc in samples.

    ``boxes[i, :2]`` are the first column and the one past the last, ``boxes[i, 2:]`` likewise the
    lines. A disc that no sample can hit gets an empty box.
    """
    focal, middle_x, middle_y, near = optics
    for i in range(len(centres)):
        boxes[i] = 0
        radius = radii[i]
        reach = radius * np.sqrt(max(0.0, 1.0 - normals[i, 2] ** 2))
        if not facing[i] or radius == 0.0 or centres[i, 2] + reach < near:
            continue
        crosses = centres[i, 2] - reach < near
        for axis in range(2):
            if crosses:
                low, high = bound_part(centres[i], normals[i], radius, axis, near)
            else:
                low, high = bound_disc(centres[i], normals[i], radius, axis)
            # The bounds are clipped as floats, since those far outside the image do not fit an
            # integer. One sample more on either side allows for rounding.
            limit = float(size[axis])
            middle = middle_y if axis else middle_x
            first = np.floor(middle + focal * low - 0.5) - 1.0
            last = np.ceil(middle + focal * high - 0.5) + 1.0
            boxes[i, 2 * axis] = int(min(max(first, 0.0), limit))
            boxes[i, 2 * axis + 1] = int(min(max(last + 1.0, 0.0), limit))


@cached_njit()
def bound_disc(centre: Any, normal: Any, radius: float, axis: int) -> tuple[float, float]:
    """Return the least and the greatest ``x / z`` (or ``y / z``) of a disc in front of the eye.

    The plane x = k z passes through the eye and has the normal w = (1, 0, -k). It touches the disc
    if the centre's distance from it equals the disc's extent along w, which is a quadratic equation
    in k: ``(w.p)^2 = R^2 (|w|^2 - (w.n)^2)``.
    """
    p, n = centre[axis], normal[axis]
    pz, nz = centre[2], normal[2]
    square = radius * radius
    a = pz * pz - square * (1.0 - nz * nz)  # positive, as the whole disc has z > 0
    b = p * pz + square * n * nz
    c = p * p - square * (1.0 - n * n)
    root = np.sqrt(max(0.0, b * b - a * c))
    return (b - root) / a, (b + root) / a


@cached_njit()
def bound_part(
    centre: Any, normal: Any, radius: float, axis: int, near: float
) -> tuple[float, float]:
    """Return bounds of ``x / z`` over a disc's part beyond the near plane; they are not tight."""
    extent = radius * np.sqrt(max(0.0, 1.0 - normal[axis] ** 2))
    deepest = centre[2] + radius * np.sqrt(max(0.0, 1.0 - normal[2] ** 2))
    low = centre[axis] - extent
    high = centre[axis] + extent
    return min(low / near, low / deepest), max(high / near, high / deepest)


@cached_njit()
def sort_into_bands(boxes: Any, band: int, bands: int) -> tuple[Any, Any]:
    """Return the discs of each band of sample lines: ``members[starts[b]:starts[b + 1]]``.

    A disc belongs to every band that its box overlaps. Within a band the discs keep their order.
    """
    starts = np.zeros(bands + 1, np.int64)
    for i in range(len(boxes)):
        if boxes[i, 0] < boxes[i, 1] and boxes[i, 2] < boxes[i, 3]:
            for b in range(boxes[i, 2] // band, (boxes[i, 3] - 1) // band + 1):
                starts[b + 1] += 1
    starts = np.cumsum(starts)
    fill = starts.copy()
    members = np.empty(starts[-1], np.int64)
    for i in range(len(boxes)):
        if boxes[i, 0] < boxes[i, 1] and boxes[i, 2] < boxes[i, 3]:
            for b in range(boxes[i, 2] // band, (boxes[i, 3] - 1) // band + 1):
                members[fill[b]] = i
                fill[b] += 1
    return starts, members


@cached_njit(parallel=True, error_model="numpy")
def draw_bands(
    bands: tuple[int, int],
    starts: Any,
    members: Any,
    boxes: Any,
    centres: Any,
    normals: Any,
    radii: Any,
    colours: Any,
    optics: tuple[float, float, float, float],
    samples: int,
    background: Any,
    rgb: Any,
    depth: Any,
    coverage: Any,
) -> None:
    """Draw some bands: the first and the one past the last.

    They are independent, so that the picture does not depend on the threads.
    """
    height, width = depth.shape
    for band in numba.prange(bands[0], bands[1]):
        top = band * BAND
        lines = min(BAND, height - top)
        nearest = np.full((lines * samples, width * samples), np.inf)
        seen = np.full((lines * samples, width * samples), -1, np.int64)
        for member in range(starts[band], starts[band + 1]):
            i = members[member]
            _draw_disc(
                i,
                boxes[i],
                centres[i],
                normals[i],
                radii[i],
                optics,
                top * samples,
                nearest,
                seen,
            )
        rows = slice(top, top + lines)
        _mean(nearest, seen, colours, samples, background, rgb[rows], depth[rows], coverage[rows])


@cached_njit(error_model="numpy")
def _draw_disc(
    i: int,
    box: Any,
    centre: Any,
    normal: Any,
    radius: float,
    optics: tuple[float, float, float, float],
    top: int,
    nearest: Any,
    seen: Any,
) -> None:
    """Draw a disc into a band whose first sample line is ``top``.

    The ray (x, y, 1) t hits the plane at ``t = n.p / n.(x, y, 1)``, and t is also the depth.
    """
    focal, middle_x, middle_y, near = optics
    pull = normal[0] * centre[0] + normal[1] * centre[1] + normal[2] * centre[2]
    square = radius * radius
    for line in range(max(box[2], top), min(box[3], top + len(nearest))):
        y = (line + 0.5 - middle_y) / focal
        for column in range(box[0], box[1]):
            x = (column + 0.5 - middle_x) / focal
            t = pull / (normal[0] * x + normal[1] * y + normal[2])
            if near <= t < nearest[line - top, column]:
                dx = t * x - centre[0]
                dy = t * y - centre[1]
                dz = t - centre[2]
                if dx * dx + dy * dy + dz * dz <= square:
                    nearest[line - top, column] = t
                    seen[line - top, column] = i


@cached_njit()
def _mean(
    nearest: Any,
    seen: Any,
    colours: Any,
    samples: int,
    background: Any,
    rgb: Any,
    depth: Any,
    coverage: Any,
) -> None:
    """Average a band's samples over each pixel."""
    height, width = depth.shape
    every = samples * samples
    for line in range(height):
        for column in range(width):
            met = 0
            distance = 0.0
            red, green, blue = 0.0, 0.0, 0.0
            for j in range(line * samples, (line + 1) * samples):
                for k in range(column * samples, (column + 1) * samples):
                    i = seen[j, k]
                    if i >= 0:
                        met += 1
                        distance += nearest[j, k]
                        red += colours[i, 0]
                        green += colours[i, 1]
                        blue += colours[i, 2]
            rest = every - met
            rgb[line, column, 0] = (red + rest * background[0]) / every
            rgb[line, column, 1] = (green + rest * background[1]) / every
            rgb[line, column, 2] = (blue + rest * background[2]) / every
            coverage[line, column] = met / every
            depth[line, column] = distance / met if met else np.nan
