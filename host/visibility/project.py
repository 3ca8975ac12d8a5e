"""Projection: from points in space to splats on the image, culled and shaded on the way."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.shading.normal_levels import quantise

from .block_index import BLOCK_POINTS, Index
from .cull import Camera, cull_blocks, faces_away, in_camera, lies_outside, misses_centre
from .skips import DEFAULT_SKIPS, REASONS, SKIPS
from .view import LARGEST, View

__all__ = ["SPLAT", "Splats", "project"]

STEEPEST = 1e-6
"""Least cosine between a normal and the ray that slopes are computed for: they stay finite."""

CROWDED = 0.5
"""Pixels between neighbours below which points are crowded: more than four of them a pixel."""

CHUNKS = 64
"""Parts of the work, the same on every machine so that results do not depend on it."""

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
"""Numbers of the first fields among a splat's eight float32."""

LOOK = 5
"""Number of the look among a splat's eight uint32."""

DEPTH = 3
"""Number of the depth among a splat's four float64."""

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

        Compiled code works on these views. Each use of a structured row counts references, which
        takes longer than all of the projection.
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
    """Project a cloud's discs and leave out those that the view does not show.

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
        The view.
    shades
        DIFFUSE and SPECULAR by quantised normal; see ``shade_bits``.
    material_shift
        Lowest bit of MATERIAL, counted from DIFFUSE's.
    skips
        Reasons to leave points out; see ``SKIPS``. Points nearer than the view's near distance are
        always left out.

    Returns
    -------
    Splats
        In the index's order.
    """
    camera = Camera.of(view)
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
    _project(
        Points(index.positions, index.normals, index.two_sided, index.radii, index.materials.index),
        Blocks(index.bounds, visible, cuts),
        camera,
        Look(rules, shades, material_shift),
        Slots(*splats.views(), stops, limits, reasons),
    )
    tally += reasons.sum(axis=0)
    low, high = float(limits[:, 0].min()), float(limits[:, 1].max())
    return dataclasses.replace(
        splats,
        depth_range=(low, high) if (stops > starts).any() else (0.0, 0.0),
        culled={name: int(tally[reason]) for name, reason in REASONS.items()},
    )


class Points(NamedTuple):
    """The points of an index; see ``Index``."""

    positions: npt.NDArray[np.float64]
    normals: npt.NDArray[np.float32]
    two_sided: npt.NDArray[np.bool_]
    radii: npt.NDArray[np.float64]
    material: npt.NDArray[np.uint8]


class Blocks(NamedTuple):
    """The blocks of an index.

    Parameters
    ----------
    bounds
        Bounds of every block; see ``BOUND``.
    visible
        Numbers of the blocks that were not culled.
    cuts
        Where each chunk begins in ``visible``, and the end: shape (CHUNKS + 1,).
    """

    bounds: npt.NDArray[Any]
    visible: npt.NDArray[np.int64]
    cuts: npt.NDArray[np.int64]


class Look(NamedTuple):
    """Rules for culling, and tables for shading.

    Parameters
    ----------
    rules
        Whether each reason to leave a point out counts, by its number.
    shades, material_shift
        See :func:`project`.
    """

    rules: npt.NDArray[np.bool_]
    shades: npt.NDArray[np.uint32]
    material_shift: int


class Slots(NamedTuple):
    """The results of the projection.

    Parameters
    ----------
    floats, bits, doubles
        Views of the splats' slots; see ``Splats.views``.
    stops, limits
        Of each chunk the end of its slots, and its least and greatest depth.
    reasons
        Points of each chunk that were left out, by reason.
    """

    floats: npt.NDArray[Any]
    bits: npt.NDArray[Any]
    doubles: npt.NDArray[Any]
    stops: npt.NDArray[np.int64]
    limits: npt.NDArray[np.float64]
    reasons: npt.NDArray[np.int64]


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _project(points: Any, blocks: Any, camera: Any, look: Any, slots: Any) -> None:
    """Project the visible blocks, chunk by chunk, each into its own slots.

    Tuples of arrays are unpacked before the loops: inside, numba would count references for every
    point.
    """
    bounds, visible, cuts = blocks
    positions, normals, two_sided, radii, material = points
    rules, shades, material_shift = look
    floats, bits, doubles, stops, limits, reasons = slots
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
                stride = _stride(bounds[block], camera)
                growth = math.sqrt(stride)
                tally[CROWDED_OUT] += stop - start - (stop - start + stride - 1) // stride
            for i in range(start, stop, stride):
                position = positions[i, 0], positions[i, 1], positions[i, 2]
                reason, image = _project_disc(position, growth * radii[i], camera, rules)
                if reason == 0:
                    normal = normals[i, 0], normals[i, 1], normals[i, 2]
                    reason, slopes, shade = _orient(
                        normal, two_sided[i], image.a, image.b, camera, rules, shades
                    )
                if reason == 0:
                    floats[at, COLUMN], floats[at, LINE] = image.column, image.line
                    floats[at, DIAMETER] = 2.0 * image.radius
                    floats[at, SLOPE_X], floats[at, SLOPE_Y] = slopes
                    bits[at, LOOK] = shade | np.uint32(material[i]) << np.uint32(material_shift)
                    doubles[at, DEPTH] = image.z
                    low, high = min(low, image.z), max(high, image.z)
                    at += 1
                else:
                    tally[reason] += 1
        stops[chunk] = at
        limits[chunk, 0], limits[chunk, 1] = low, high
        # One at a time: numba may drop the copy of a whole row here.
        for reason in range(len(tally)):
            reasons[chunk, reason] = tally[reason]


class Image(NamedTuple):
    """A disc on the image.

    Parameters
    ----------
    column, line
        Its centre, in pixels.
    radius
        In pixels, seen face on.
    a, b, z
        Its centre in camera coordinates: x / z, y / z and z.
    """

    column: float
    line: float
    radius: float
    a: float
    b: float
    z: float


NOWHERE = Image(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@nb.njit(inline="always")
def _project_disc(position: Any, radius: float, camera: Any, rules: Any) -> tuple[int, Any]:
    """Return the reason to leave a disc out, or 0, and its image."""
    dx = position[0] - camera.eye_x
    dy = position[1] - camera.eye_y
    dz = position[2] - camera.eye_z
    x, y, z = in_camera(camera, dx, dy, dz)
    if not z >= camera.near:
        return OUTSIDE, NOWHERE
    # Divided, not multiplied by 1 / z, which overflows where z is tiny.
    a = x / z
    b = y / z
    column = camera.middle_x + camera.focal * a
    line = camera.middle_y + camera.focal * b
    share = radius / z
    pixels = share * camera.focal
    if rules[OUTSIDE] and (
        lies_outside(column, a, pixels, share, camera.width)
        or lies_outside(line, b, pixels, share, camera.height)
    ):
        return OUTSIDE, NOWHERE
    if rules[NO_PIXEL] and pixels < 0.5 and misses_centre(column, line, pixels, a, b):
        return NO_PIXEL, NOWHERE
    if pixels > LARGEST:
        # The image is the same and nothing overflows. The axis of the view keeps its position.
        smaller = LARGEST / pixels
        column = camera.middle_x + (column - camera.middle_x) * smaller
        line = camera.middle_y + (line - camera.middle_y) * smaller
        pixels = LARGEST
    return 0, Image(column, line, pixels, a, b, z)


@nb.njit(inline="always")
def _orient(
    normal: Any, two_sided: bool, a: float, b: float, camera: Any, rules: Any, shades: Any
) -> tuple[int, Any, Any]:
    """Return the reason to leave a disc out, or 0, then its slopes n' and its shade.

    Parameters
    ----------
    normal
        In the cloud's coordinates.
    two_sided
        Whether the normal's sign means nothing.
    a, b
        x / z and y / z of the disc's centre.
    camera
        The view.
    rules, shades
        See ``Look``.
    """
    nx, ny, nz = in_camera(camera, normal[0], normal[1], normal[2])
    facing = nx * a + ny * b + nz
    if facing > 0.0 and (two_sided or not rules[FACING_AWAY]):
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    if rules[FACING_AWAY] and faces_away(facing) and not two_sided:
        return FACING_AWAY, (0.0, 0.0), np.uint32(0)

    facing = min(facing, -STEEPEST)
    # The eye sees a point near the image's border along a slant, so a front may have n_z >= 0. For
    # shading, such a normal counts as just grazing.
    towards = min(nz, -STEEPEST)
    levels = shades.shape[1]
    shade = shades[0, quantise(nx, towards, levels), quantise(ny, towards, levels)]
    # The table's viewer is on the axis. A highlight is as the true viewer sees it if the normal
    # turns along by half of the angle from his direction to the axis: n + ((n.v) e - (n.e) v) / 2.
    # v is the direction to the viewer, e the one against the axis.
    half = 0.5 / math.sqrt(a * a + b * b + 1.0)
    mx, my = nx - half * a * nz, ny - half * b * nz
    mz = min(nz + half * (facing - nz), -STEEPEST)
    shade |= shades[1, quantise(mx, mz, levels), quantise(my, mz, levels)]
    inverse = 1.0 / facing
    return 0, (nx * inverse, ny * inverse), shade


@nb.njit(error_model="numpy")
def _stride(bound: Any, camera: Any) -> int:
    """Return the step between a block's points that are drawn, so that few share a pixel.

    A disc is as wide as the points are apart (``splat_radii``), so the mean radius tells the
    distance. Every k-th point along the curve is as evenly spread as all are.
    """
    dx = bound.centre[0] - camera.eye_x
    dy = bound.centre[1] - camera.eye_y
    dz = bound.centre[2] - camera.eye_z
    _, _, z = in_camera(camera, dx, dy, dz)
    # At the block's nearest point, where points are furthest apart on the image.
    apart = bound.mean * camera.focal / max(z - bound.reach, camera.near)
    if not 0.0 < apart < CROWDED:
        return 1
    return int(min((CROWDED / apart) ** 2, float(BLOCK_POINTS)))
