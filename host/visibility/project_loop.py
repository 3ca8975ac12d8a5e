"""The compiled loop over points: each is culled, projected and shaded.

A quick test leaves out most points of a dense cloud; the others are computed in float64.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.shading.normal_levels import quantise

from .block_index import BLOCK_POINTS
from .cull import faces_away, in_camera, lies_inside, lies_outside, misses_centre
from .footprint import SMALLEST, conic, covers_own_pixel, is_tiny
from .quick_test import middle_of, stride_of
from .skips import REASONS
from .splats import COLUMN, DEPTH, DIAMETER, LINE, LOOK, SLOPE_X, SLOPE_Y
from .view import LARGEST

__all__ = ["WINDOW", "Look", "Slots", "project_blocks"]

STEEPEST = 1e-6
"""Least cosine between a normal and the ray that slopes are computed for: they stay finite."""

WINDOW = 256
"""Lines and columns of a window. Pixels that differ by a multiple of it share an entry, so that it
stays in a core's cache; points of a chunk lie together."""

NO_RIVAL = -1
"""Slot of a splat that is not there."""

OUTSIDE, FACING_AWAY = REASONS["outside"], REASONS["facing_away"]
NO_PIXEL, CROWDED_OUT = REASONS["no_pixel"], REASONS["crowded"]
OVERDRAWN = REASONS["overdrawn"]


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
    starts, stops, limits
        Of each chunk its first slot, the end of its slots, and its least and greatest depth.
    reasons
        Points of each chunk that were left out, by reason; those left out here are added.
    nearest
        For each thread and pixel of a window a splat's slot: shape (threads, ``WINDOW`` squared),
        int32. It counts if the slot is one of the chunk and its splat lies in the pixel. Then the
        splat is the nearest that covers the pixel's centre and no other.
    """

    floats: npt.NDArray[Any]
    bits: npt.NDArray[Any]
    doubles: npt.NDArray[Any]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    limits: npt.NDArray[np.float64]
    reasons: npt.NDArray[np.int64]
    nearest: npt.NDArray[np.int32]


@nb.njit(parallel=True, cache=True, error_model="numpy")
def project_blocks(points: Any, blocks: Any, camera: Any, look: Any, slots: Any) -> None:
    """Project the visible blocks, chunk by chunk, each into its own slots.

    Tuples of arrays are unpacked before the loops: inside, numba would count references for every
    point.
    """
    bounds, visible, cuts, found = blocks
    discs, two_sided, thin, material, positions, radii = points
    rules, shades, material_shift = look
    floats, bits, doubles, starts, stops, limits, reasons, nearest = slots
    inverse_focal = 1.0 / camera.focal
    for chunk in nb.prange(len(cuts) - 1):
        first = starts[chunk]
        at = first
        rivals = nearest[nb.get_thread_id()]
        low, high = np.inf, -np.inf
        tally = np.zeros(reasons.shape[1], np.int64)
        for number in range(cuts[chunk], cuts[chunk + 1]):
            bound = bounds[visible[number]]
            start = BLOCK_POINTS * visible[number]
            stop = min(start + BLOCK_POINTS, len(two_sided))
            growth = math.sqrt(stride_of(bound, camera)) if rules[CROWDED_OUT] else 1.0
            middle = middle_of(bound, camera)
            at_border = rules[OUTSIDE] and not lies_inside(bound, middle, growth, camera)
            for i in range(start, stop):
                if found[BLOCK_POINTS * number + i - start]:
                    continue
                x, y, z = in_camera(
                    camera,
                    positions[i, 0] - camera.eye_x,
                    positions[i, 1] - camera.eye_y,
                    positions[i, 2] - camera.eye_z,
                )
                reason, image = _project_disc(
                    x,
                    y,
                    z,
                    growth * radii[i],
                    camera,
                    rules[NO_PIXEL] and not thin[i],
                    at_border,
                )
                if reason != 0:
                    tally[reason] += 1
                    continue
                # As the encoder will compute it from the splat, to the last bit.
                a = (image.column - camera.middle_x) * inverse_focal
                b = (image.line - camera.middle_y) * inverse_focal
                rival, place = NO_RIVAL, 0
                tiny = is_tiny(image.radius, a, b, inverse_focal)
                alone = tiny and rules[OVERDRAWN]
                if alone:
                    rival, place = _find_rival(image, rivals, floats, first, at)
                    if rival != NO_RIVAL and doubles[rival, DEPTH] <= image.z:
                        tally[OVERDRAWN] += 1
                        continue
                reason, facing, nx, ny, nz = _turn(
                    discs[4, i],
                    discs[5, i],
                    discs[6, i],
                    two_sided[i],
                    thin[i],
                    image,
                    camera,
                    rules,
                )
                slopes = np.float32(nx / facing), np.float32(ny / facing)
                column, line, radius = image.column, image.line, image.radius
                if reason == 0 and tiny and (alone or thin[i]) and not _covers(image, a, b, slopes):
                    if thin[i]:  # the pixel that it lies in
                        column, line = math.floor(column) + 0.5, math.floor(line) + 0.5
                        slopes = np.float32(0.0), np.float32(0.0)
                        radius = max(radius, SMALLEST)
                    else:
                        reason, alone = NO_PIXEL if rules[NO_PIXEL] else 0, False
                if reason != 0:
                    tally[reason] += 1
                    continue
                low, high = min(low, z), max(high, z)
                slot = at
                if alone and rival != NO_RIVAL:
                    slot = rival
                    tally[OVERDRAWN] += 1
                else:
                    at += 1
                if alone:
                    rivals[place] = slot
                shade = _shade(nx, ny, nz, facing, image, shades)
                floats[slot, COLUMN], floats[slot, LINE] = column, line
                floats[slot, DIAMETER] = 2.0 * radius
                floats[slot, SLOPE_X], floats[slot, SLOPE_Y] = slopes
                bits[slot, LOOK] = shade | np.uint32(material[i]) << np.uint32(material_shift)
                doubles[slot, DEPTH] = z
        stops[chunk] = at
        limits[chunk, 0], limits[chunk, 1] = low, high
        # One at a time: numba may drop the copy of a whole row here.
        for reason in range(len(tally)):
            reasons[chunk, reason] += tally[reason]


@nb.njit(inline="always")
def _find_rival(image: Any, rivals: Any, floats: Any, first: int, at: int) -> tuple[int, int]:
    """Return the slot of the splat that covers an image's pixel alone, if any, and its entry.

    Parameters
    ----------
    image
        The image of a tiny disc.
    rivals
        The thread's window; see ``Slots.nearest``.
    floats
        See ``Splats.views``.
    first, at
        The chunk's slots so far.
    """
    column, line = math.floor(image.column), math.floor(image.line)
    place = (line & WINDOW - 1) * WINDOW + (column & WINDOW - 1)
    rival = rivals[place]
    if not first <= rival < at:
        return NO_RIVAL, place
    same = math.floor(floats[rival, COLUMN]) == column and math.floor(floats[rival, LINE]) == line
    return rival if same else NO_RIVAL, place


@nb.njit(inline="always")
def _covers(image: Any, a: float, b: float, slopes: Any) -> bool:
    """Return whether a tiny splat covers the centre of its own pixel."""
    form = conic(a, b, np.float64(slopes[0]), np.float64(slopes[1]))
    radius = image.radius if image.radius > SMALLEST else SMALLEST
    return covers_own_pixel(image.column, image.line, radius * radius, form)


class Image(NamedTuple):
    """A disc on the image.

    Parameters
    ----------
    column, line
        Its centre, in pixels.
    radius
        In pixels, seen face on. These three are rounded to float32.
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
def _project_disc(
    x: float, y: float, z: float, radius: float, camera: Any, may_miss: bool, at_border: bool
) -> tuple[int, Any]:
    """Return the reason to leave a disc out, or 0, and its image.

    Parameters
    ----------
    x, y, z, radius
        Its centre in camera coordinates, and its radius.
    camera
        The view.
    may_miss
        Whether it is left out if it covers no pixel's centre.
    at_border
        Whether it may lie outside of the image and is left out then.
    """
    if not z >= camera.near:
        return OUTSIDE, NOWHERE
    # Divided, not multiplied by 1 / z, which overflows where z is tiny.
    a = x / z
    b = y / z
    column = camera.middle_x + camera.focal * a
    line = camera.middle_y + camera.focal * b
    share = radius / z
    pixels = share * camera.focal
    if at_border and (
        lies_outside(column, a, pixels, share, camera.width)
        or lies_outside(line, b, pixels, share, camera.height)
    ):
        return OUTSIDE, NOWHERE
    if may_miss and pixels < 0.5 and misses_centre(column, line, pixels, a, b):
        return NO_PIXEL, NOWHERE
    if pixels > LARGEST:
        # The image is the same and nothing overflows. The axis of the view keeps its position.
        smaller = LARGEST / pixels
        column = camera.middle_x + (column - camera.middle_x) * smaller
        line = camera.middle_y + (line - camera.middle_y) * smaller
        pixels = LARGEST
    # As a splat holds it.
    column, line = np.float64(np.float32(column)), np.float64(np.float32(line))
    pixels = 0.5 * np.float64(np.float32(2.0 * pixels))
    return 0, Image(column, line, pixels, a, b, z)


@nb.njit(inline="always")
def _turn(
    x: float,
    y: float,
    z: float,
    two_sided: bool,
    thin: bool,
    image: Any,
    camera: Any,
    rules: Any,
) -> tuple[int, float, float, float, float]:
    """Return the reason to leave a disc out, or 0, and its normal, which is turned to the eye.

    Parameters
    ----------
    x, y, z
        The normal in the cloud's coordinates.
    two_sided
        Whether the normal's sign means nothing.
    thin
        Whether the point is on a curve or alone. If its normal is estimated, it means nothing, and
        the disc faces the eye.
    image
        The disc's.
    camera
        The view.
    rules
        See ``Look``.

    Returns
    -------
    reason
        The reason, or 0.
    facing
        n . (a, b, 1), below 0.
    nx, ny, nz
        The normal in camera coordinates.
    """
    nx, ny, nz = in_camera(camera, x, y, z)
    if thin and two_sided:
        away = 1.0 / math.sqrt(image.a * image.a + image.b * image.b + 1.0)
        nx, ny, nz = -image.a * away, -image.b * away, -away
    facing = nx * image.a + ny * image.b + nz
    reason = 0
    if facing > 0.0 and (two_sided or not rules[FACING_AWAY]):
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    if rules[FACING_AWAY] and faces_away(facing) and not two_sided:
        reason = FACING_AWAY
    return reason, min(facing, -STEEPEST), nx, ny, nz


@nb.njit(inline="always")
def _shade(nx: float, ny: float, nz: float, facing: float, image: Any, shades: Any) -> int:
    """Return DIFFUSE and SPECULAR of a disc; see :func:`_turn` and ``Look``."""
    # The eye sees a point near the image's border along a slant, so a front may have n_z >= 0. For
    # shading, such a normal counts as just grazing.
    towards = min(nz, -STEEPEST)
    levels = shades.shape[1]
    shade = shades[0, quantise(nx, towards, levels), quantise(ny, towards, levels)]
    # The table's viewer is on the axis. A highlight is as the true viewer sees it if the normal
    # turns along by half of the angle from his direction to the axis: n + ((n.v) e - (n.e) v) / 2.
    # v is the direction to the viewer, e the one against the axis.
    a, b = image.a, image.b
    half = 0.5 / math.sqrt(a * a + b * b + 1.0)
    mx, my = nx - half * a * nz, ny - half * b * nz
    mz = min(nz + half * (facing - nz), -STEEPEST)
    return shade | shades[1, quantise(mx, mz, levels), quantise(my, mz, levels)]
