"""The exact reference: true discs in perspective, in float64, supersampled.

It is the measure of error, so it draws what the engine approximates: every point is a disc in
space, every sample a ray that meets the disc's plane, at its own depth, and nothing is quantised.
Of the host it knows the data alone (cloud, view and lighting), not how they become code words.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View

__all__ = ["Reference", "bound_disc", "bound_part", "render"]

_Floats = npt.NDArray[np.float64]

BAND = 16
"""Lines of the image that are drawn together: their samples stay in a core's cache."""

MOST_SAMPLES = 16


@dataclass(frozen=True)
class Reference:
    """An exact picture.

    Parameters
    ----------
    rgb
        Shape (height, width, 3), float64, 0..1: mean of the pixel's samples, background included.
    depth
        Shape (height, width), float64: mean distance along the view, in the cloud's unit, of the
        pixel's samples that meet a disc; NaN where none does.
    coverage
        Shape (height, width), float64, 0..1: share of the pixel's samples that meet a disc.
    """

    rgb: _Floats
    depth: _Floats
    coverage: _Floats


def render(
    cloud: Cloud,
    view: View,
    radii: npt.ArrayLike,
    lighting: Lighting,
    *,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    samples: int = 4,
) -> Reference:
    """Draw a cloud of discs, exactly up to the sampling.

    A point is a flat disc about its position, perpendicular to its normal, of one colour: Phong's
    model at its centre, with the direction in which the eye sees it. Discs that face away are not
    drawn; those of two-sided points are turned to the eye. Of the discs that a ray meets beyond the
    near plane the nearest is seen; of equally near ones the first in the cloud.

    Parameters
    ----------
    cloud
        Positions, normals and colours.
    view
        The camera.
    radii
        Shape (n,): radius of each point's disc, in the cloud's unit; a disc of radius 0 is nowhere.
    lighting
        The lights.
    background
        RGB in 0..1 of the samples that meet no disc.
    samples
        A pixel has ``samples x samples`` of them, evenly spread and evenly weighted; 1 takes the
        pixel's centre alone.

    Raises
    ------
    ValueError
        If ``radii`` has another shape than the cloud, is negative or not finite, or if ``samples``
        is not in 1..16.
    """
    radii = np.ascontiguousarray(radii, np.float64)
    if radii.shape != (len(cloud),):
        raise ValueError(f"there must be one radius a point, {len(cloud)}, not {radii.shape}")
    if not (np.isfinite(radii) & (radii >= 0.0)).all():
        raise ValueError("radii must be finite and at least 0")
    if not 1 <= samples <= MOST_SAMPLES:
        raise ValueError(f"samples must be in 1..{MOST_SAMPLES}, not {samples}")

    centres = (cloud.positions - view.eye) @ view.axes.T
    normals, facing = _face_eye(cloud, view, centres)
    colours = _shade(cloud.colours, normals, centres, lighting)

    size = (view.width * samples, view.height * samples)
    optics = (view.focal * samples, view.middle[0] * samples, view.middle[1] * samples, view.near)
    boxes = np.empty((len(cloud), 4), np.int64)
    _bound_discs(centres, normals, facing, radii, optics, size, boxes)
    band = BAND * samples
    starts, members = _sort_into_bands(boxes, band, -(-size[1] // band))

    rgb = np.empty((view.height, view.width, 3))
    depth = np.empty((view.height, view.width))
    coverage = np.empty((view.height, view.width))
    _draw_bands(
        starts,
        members,
        boxes,
        centres,
        normals,
        radii,
        colours,
        optics,
        samples,
        np.asarray(background, np.float64),
        rgb,
        depth,
        coverage,
    )
    return Reference(rgb, depth, coverage)


def _face_eye(cloud: Cloud, view: View, centres: _Floats) -> tuple[_Floats, npt.NDArray[np.bool_]]:
    """Return unit normals in camera axes, two-sided ones turned, and which discs face the eye."""
    normals = cloud.normals.astype(np.float64) @ view.axes.T
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    away = np.einsum("ij,ij->i", normals, centres)
    turned = cloud.two_sided & (away > 0.0)
    normals[turned] *= -1.0
    # Edge-on or without a normal: away is 0, and the disc has no area.
    return normals, (away < 0.0) | turned


def _shade(
    base: npt.NDArray[np.uint8], normals: _Floats, centres: _Floats, lighting: Lighting
) -> _Floats:
    """Return the colour that each disc shows: Phong's model, as :class:`Lighting` states it.

    A light behind a disc gives it nothing, no highlight either.
    """
    distances = np.linalg.norm(centres, axis=1, keepdims=True)
    to_eye = np.divide(-centres, distances, out=np.zeros_like(centres), where=distances > 0.0)
    diffuse = np.full(len(centres), lighting.ambient)
    specular = np.zeros(len(centres))
    for light in lighting.lights:
        direction = np.asarray(light.direction, np.float64)
        length = np.linalg.norm(direction)
        direction = direction / length
        incidence = normals @ direction
        mirrored = 2.0 * incidence[:, np.newaxis] * normals - direction
        glance = np.maximum(np.einsum("ij,ij->i", mirrored, to_eye), 0.0)
        diffuse += light.intensity * np.maximum(incidence, 0.0)
        specular += np.where(incidence > 0.0, light.intensity * glance**lighting.shininess, 0.0)
    diffuse = np.clip(diffuse, 0.0, 1.0)
    specular = np.clip(specular, 0.0, 1.0)
    shown: _Floats = base / 255.0 * diffuse[:, np.newaxis]
    shown += lighting.gloss * specular[:, np.newaxis]
    return shown.clip(0.0, 1.0)


@numba.njit(cache=True)
def _bound_discs(
    centres: Any,
    normals: Any,
    facing: Any,
    radii: Any,
    optics: tuple[float, float, float, float],
    size: tuple[int, int],
    boxes: Any,
) -> None:
    """Set the samples that each disc may meet: columns ``boxes[i, :2]`` and lines ``boxes[i, 2:]``.

    First and one past the last; a disc that can meet none has no columns.
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
            # Clipped as floats: far outside the image they do not fit an integer. A sample more on
            # either side makes up for rounding.
            limit = float(size[axis])
            middle = middle_y if axis else middle_x
            first = np.floor(middle + focal * low - 0.5) - 1.0
            last = np.ceil(middle + focal * high - 0.5) + 1.0
            boxes[i, 2 * axis] = int(min(max(first, 0.0), limit))
            boxes[i, 2 * axis + 1] = int(min(max(last + 1.0, 0.0), limit))


@numba.njit(cache=True)
def bound_disc(centre: Any, normal: Any, radius: float, axis: int) -> tuple[float, float]:
    """Return the least and the greatest ``x / z`` (or ``y / z``) of a disc in front of the eye.

    The plane x = k z through the eye, with the normal w = (1, 0, -k), touches the disc where the
    centre's distance equals the disc's extent along w: ``(w.p)^2 = R^2 (|w|^2 - (w.n)^2)``, a
    quadratic in k.
    """
    p, n = centre[axis], normal[axis]
    pz, nz = centre[2], normal[2]
    square = radius * radius
    a = pz * pz - square * (1.0 - nz * nz)  # above 0, since the disc's nearest point is
    b = p * pz + square * n * nz
    c = p * p - square * (1.0 - n * n)
    root = np.sqrt(max(0.0, b * b - a * c))
    return (b - root) / a, (b + root) / a


@numba.njit(cache=True)
def bound_part(
    centre: Any, normal: Any, radius: float, axis: int, near: float
) -> tuple[float, float]:
    """Return bounds of ``x / z``, not the tightest, of a disc's part beyond the near plane."""
    extent = radius * np.sqrt(max(0.0, 1.0 - normal[axis] ** 2))
    deepest = centre[2] + radius * np.sqrt(max(0.0, 1.0 - normal[2] ** 2))
    low = centre[axis] - extent
    high = centre[axis] + extent
    return min(low / near, low / deepest), max(high / near, high / deepest)


@numba.njit(cache=True)
def _sort_into_bands(boxes: Any, band: int, bands: int) -> tuple[Any, Any]:
    """Return the discs of each band of sample lines: ``members[starts[b]:starts[b + 1]]``.

    A disc is in every band that it reaches into; within a band they keep their order.
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


@numba.njit(cache=True, parallel=True, error_model="numpy")
def _draw_bands(
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
    """Draw the bands, each on its own, so that the picture does not depend on the threads."""
    height, width = depth.shape
    for band in numba.prange(len(starts) - 1):
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


@numba.njit(cache=True, error_model="numpy")
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

    The ray (x, y, 1) t meets the plane at ``t = n.p / n.(x, y, 1)``, which is the depth as well.
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


@numba.njit(cache=True)
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
    """Turn a band's samples into pixels."""
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
