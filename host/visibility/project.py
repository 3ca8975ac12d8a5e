"""Projection: from points in space to splats on the image, culled and shaded on the way."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.shading.normal_levels import quantise

from .block_index import BLOCK_POINTS, Index
from .cull import cull_blocks, faces_away, lies_outside, misses_centre
from .skips import DEFAULT_SKIPS, REASONS, SKIPS
from .view import LARGEST, View

__all__ = ["SPLAT", "Splats", "project"]

STEEPEST = 1e-6
"""Least cosine between a normal and the ray that slopes are computed for: they stay finite."""

CROWDED = 0.5
"""Pixels between neighbours below which points are crowded: more than four of them a pixel."""

CHUNKS = 64
"""Parts that work is cut into; the same on every machine, so that results do not depend on it."""

SPLAT = np.dtype(
    [
        ("column", np.float32),  # centre on the image, in pixels
        ("line", np.float32),
        ("diameter", np.float32),  # of the disc seen face on, in pixels
        ("slope_x", np.float32),  # n'x and n'y
        ("slope_y", np.float32),
        ("look", np.uint32),  # DIFFUSE, SPECULAR and MATERIAL as they lie in a code word
        ("depth", np.float64),  # distance along the view, in the cloud's unit
    ]
)
"""A splat: 32 bytes."""

COLUMN, LINE, DIAMETER, SLOPE_X, SLOPE_Y = range(5)
"""Where the first fields are among a splat's eight float32."""

LOOK = 5
"""Where the look is among a splat's eight uint32."""

DEPTH = 3
"""Where the depth is among a splat's four float64."""

OUTSIDE, FACING_AWAY = REASONS["outside"], REASONS["facing_away"]
NO_PIXEL, CROWDED_OUT = REASONS["no_pixel"], REASONS["crowded"]


@dataclass(frozen=True)
class Splats:
    """The points that a view may show, as ellipses on the image.

    Parameters
    ----------
    data
        Splats in chunks, with gaps between: shape (slots,), structured, see ``SPLAT``.
    starts, stops
        The slots of each chunk: shape (CHUNKS,), int64.
    nearest
        Least depth of each chunk; infinite if it is empty: shape (CHUNKS,), float64.
    depth_range
        Least and greatest depth; (0, 0) if there is no splat.
    culled
        Points left out, by reason.
    """

    data: npt.NDArray[Any]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    nearest: npt.NDArray[np.float64]
    depth_range: tuple[float, float]
    culled: dict[str, int]

    def __len__(self) -> int:
        """Return the number of splats."""
        return int((self.stops - self.starts).sum())

    def views(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
        """Return the data as float32 and uint32, (slots, 8), and as float64, (slots, 4).

        Compiled code works on these: each use of a structured row counts references, which takes
        longer than all of the projection.
        """
        slots = len(self.data)
        kinds = (np.float32, 8), (np.uint32, 8), (np.float64, 4)
        first, second, third = (self.data.view(kind).reshape(slots, n) for kind, n in kinds)
        return first, second, third

    def together(self) -> npt.NDArray[Any]:
        """Return the splats without gaps: shape (m,), structured."""
        parts = zip(self.starts, self.stops, strict=True)
        return np.concatenate([self.data[start:stop] for start, stop in parts])

    @classmethod
    def of(cls, data: npt.NDArray[Any]) -> Splats:
        """Return splats given as one array, in a single chunk."""
        limits = (float(data["depth"].min()), float(data["depth"].max())) if len(data) else (0, 0)
        return cls(data, np.array([0]), np.array([len(data)]), np.zeros(1), limits, {})


def project(
    index: Index,
    view: View,
    shades: npt.NDArray[np.uint32],
    material_shift: int,
    skips: frozenset[str] = DEFAULT_SKIPS,
) -> Splats:
    """Project a cloud's discs and leave out what the view does not show.

    A disc with centre p and unit normal n, in camera coordinates, holds the points q = p + d with
    n . d = 0 and |d| <= R. With a = p_x / p_z, b = p_y / p_z, and s, t the offset on the image
    from the centre times p_z / focal, the plane gives d_z = -(n'x s + n'y t), where
    n' = (n_x, n_y) / (n . (a, b, 1)). To first order |d|^2 = s^2 + t^2 + d_z^2: the paper's
    ellipse of radius R focal / p_z pixels.

    Parameters
    ----------
    index
        The points.
    view
        Where they are looked at from.
    shades
        DIFFUSE and SPECULAR by quantised normal; see ``shade_bits``.
    material_shift
        Lowest bit of MATERIAL, counted from DIFFUSE's.
    skips
        What to leave out; see ``SKIPS``. Points nearer than the view's near distance always are.

    Returns
    -------
    Splats
        In the index's order.
    """
    camera = (view.eye, view.axes, view.focal, *view.middle, view.width, view.height, view.near)
    rules = np.array([False, *(name in skips for name in SKIPS)])
    status = np.empty(len(index.bounds), np.uint8)
    cull_blocks(index.bounds, camera, rules, status)
    sizes = np.full(len(status), BLOCK_POINTS)
    sizes[-1:] = len(index) - BLOCK_POINTS * (len(status) - 1)
    tally = np.bincount(status, weights=sizes, minlength=1 + len(SKIPS)).astype(np.int64)

    visible = np.flatnonzero(status == 0)
    cuts = np.linspace(0, len(visible), CHUNKS + 1).astype(np.int64)
    starts = BLOCK_POINTS * cuts[:-1]
    stops = np.empty(CHUNKS, np.int64)
    limits = np.empty((CHUNKS, 2))
    data = np.empty(BLOCK_POINTS * len(visible), SPLAT)
    splats = Splats(data, starts, stops, limits[:, 0], (0.0, 0.0), {})
    reasons = np.zeros((CHUNKS, 1 + len(SKIPS)), np.int64)
    points = (index.positions, index.normals, index.two_sided, index.radii, index.materials.index)
    _project(
        points,
        (index.bounds, visible, cuts),
        camera,
        (rules, shades, material_shift),
        *splats.views(),
        stops,
        limits,
        reasons,
    )
    tally += reasons.sum(axis=0)
    low, high = float(limits[:, 0].min()), float(limits[:, 1].max())
    return dataclasses.replace(
        splats,
        depth_range=(low, high) if (stops > starts).any() else (0.0, 0.0),
        culled={name: int(tally[reason]) for name, reason in REASONS.items()},
    )


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _project(
    points: Any,
    blocks: Any,
    camera: Any,
    look: Any,
    floats: Any,
    bits: Any,
    doubles: Any,
    stops: Any,
    limits: Any,
    reasons: Any,
) -> None:
    """Project the visible blocks, chunk by chunk, each into its own slots.

    All tuples are taken apart before the loops: inside, each counts references for every point.
    """
    bounds, visible, cuts = blocks
    positions, normals, two_sided, radii, material = points
    eye, axes, focal, middle_x, middle_y, width, height, near = camera
    rules, shades, material_shift = look
    for chunk in nb.prange(len(cuts) - 1):
        at = BLOCK_POINTS * cuts[chunk]
        low, high = np.inf, -np.inf
        tally = np.zeros(reasons.shape[1], np.int64)
        for number in range(cuts[chunk], cuts[chunk + 1]):
            block = visible[number]
            start = BLOCK_POINTS * block
            stop = min(start + BLOCK_POINTS, len(positions))
            stride, growth = 1, 1.0
            if rules[CROWDED_OUT]:
                stride = _stride(bounds[block], eye, axes, focal, near)
                growth = math.sqrt(stride)
                tally[CROWDED_OUT] += stop - start - (stop - start + stride - 1) // stride
            for i in range(start, stop, stride):
                reason = _project_point(
                    i,
                    growth,
                    positions,
                    normals,
                    two_sided,
                    radii,
                    material,
                    eye,
                    axes,
                    focal,
                    middle_x,
                    middle_y,
                    width,
                    height,
                    near,
                    rules,
                    shades,
                    material_shift,
                    at,
                    floats,
                    bits,
                    doubles,
                )
                if reason == 0:
                    depth = doubles[at, DEPTH]
                    low, high = min(low, depth), max(high, depth)
                    at += 1
                else:
                    tally[reason] += 1
        stops[chunk] = at
        limits[chunk, 0], limits[chunk, 1] = low, high
        # One at a time: numba has been seen to drop the copy of a whole row here.
        for reason in range(len(tally)):
            reasons[chunk, reason] = tally[reason]


@nb.njit(inline="always")
def _project_point(
    i: int,
    growth: float,
    positions: Any,
    normals: Any,
    two_sided: Any,
    radii: Any,
    material: Any,
    eye: Any,
    axes: Any,
    focal: float,
    middle_x: float,
    middle_y: float,
    width: int,
    height: int,
    near: float,
    rules: Any,
    shades: Any,
    material_shift: int,
    at: int,
    floats: Any,
    bits: Any,
    doubles: Any,
) -> int:
    """Fill in slot ``at`` and return 0, or return the reason to leave the point out."""
    dx = positions[i, 0] - eye[0]
    dy = positions[i, 1] - eye[1]
    dz = positions[i, 2] - eye[2]
    z = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
    if not z >= near:
        return OUTSIDE
    # Divided, not multiplied by 1 / z, which overflows where z is tiny.
    a = (axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz) / z
    b = (axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz) / z
    column = middle_x + focal * a
    line = middle_y + focal * b
    share = growth * radii[i] / z
    radius = share * focal
    if rules[OUTSIDE] and (
        lies_outside(column, a, radius, share, width)
        or lies_outside(line, b, radius, share, height)
    ):
        return OUTSIDE
    if rules[NO_PIXEL] and radius < 0.5 and misses_centre(column, line, radius, a, b):
        return NO_PIXEL

    wx, wy, wz = normals[i, 0], normals[i, 1], normals[i, 2]
    nx = axes[0, 0] * wx + axes[0, 1] * wy + axes[0, 2] * wz
    ny = axes[1, 0] * wx + axes[1, 1] * wy + axes[1, 2] * wz
    nz = axes[2, 0] * wx + axes[2, 1] * wy + axes[2, 2] * wz
    facing = nx * a + ny * b + nz
    if facing > 0.0 and (two_sided[i] or not rules[FACING_AWAY]):
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    if rules[FACING_AWAY] and faces_away(facing) and not two_sided[i]:
        return FACING_AWAY

    if radius > LARGEST:
        # All the same to an image, and nothing overflows: the axis of the view stays in place.
        smaller = LARGEST / radius
        column = middle_x + (column - middle_x) * smaller
        line = middle_y + (line - middle_y) * smaller
        radius = LARGEST
    facing = min(facing, -STEEPEST)
    # The eye sees a point near the image's border along a slant, so a front may have n_z >= 0: for
    # shading such a normal counts as just grazing.
    towards = min(nz, -STEEPEST)
    levels = shades.shape[1]
    shade = shades[0, quantise(nx, towards, levels), quantise(ny, towards, levels)]
    # The table's viewer is on the axis. A highlight is seen as by the true one if the normal turns
    # along by half of the way from his direction to the axis: n + ((n.v) e - (n.e) v) / 2, with v
    # and e the directions to the viewer and against the axis.
    half = 0.5 / math.sqrt(a * a + b * b + 1.0)
    mx, my = nx - half * a * nz, ny - half * b * nz
    mz = min(nz + half * (facing - nz), -STEEPEST)
    shade |= shades[1, quantise(mx, mz, levels), quantise(my, mz, levels)]
    floats[at, COLUMN], floats[at, LINE], floats[at, DIAMETER] = column, line, 2.0 * radius
    inverse = 1.0 / facing
    floats[at, SLOPE_X], floats[at, SLOPE_Y] = nx * inverse, ny * inverse
    bits[at, LOOK] = shade | np.uint32(material[i]) << np.uint32(material_shift)
    doubles[at, DEPTH] = z
    return 0


@nb.njit(error_model="numpy")
def _stride(bound: Any, eye: Any, axes: Any, focal: float, near: float) -> int:
    """Return which of a block's points to draw, one in how many, so that few crowd a pixel.

    Discs are as wide as the points are apart (``splat_radii``), so their mean radius tells the
    distance. Along the curve every k-th point is as evenly spread as all are.
    """
    z = (
        axes[2, 0] * (bound.centre[0] - eye[0])
        + axes[2, 1] * (bound.centre[1] - eye[1])
        + axes[2, 2] * (bound.centre[2] - eye[2])
    )
    # At the block's nearest, where its points are furthest apart.
    apart = bound.mean * focal / max(z - bound.reach, near)
    if not 0.0 < apart < CROWDED:
        return 1
    return int(min((CROWDED / apart) ** 2, float(BLOCK_POINTS)))
