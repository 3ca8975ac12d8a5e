"""The compiled loop over points: each is culled, projected and shaded.

A quick test leaves out most points of a dense cloud; the others are computed in float64.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.cloud.prefetch import AHEAD
from splatline.host.compiled_cache import cached_njit

from .block_index import BLOCK_BITS, BLOCK_POINTS
from .cull import from_eye, lies_inside
from .disc_image import project_disc, shade_of, turn_to_eye
from .footprint import SMALLEST, conic, covers_own_pixel, is_tiny
from .look_over import middle_of
from .point_records import MATERIAL, NORMAL, RADIUS, THIN, TWO_SIDED, prefetch_point
from .skips import REASONS
from .splats import COLUMN, DEPTH, DIAMETER, LINE, LOOK, SLOPE_X, SLOPE_Y

__all__ = ["WINDOW", "Look", "Slots", "project_blocks"]

WINDOW = 256
"""Lines and columns of a window. Pixels that differ by a multiple of it share an entry, so that it
stays in a core's cache; points of a chunk lie together."""

NO_RIVAL = -1
"""Slot of a splat that is not there."""

OUTSIDE, FACING_AWAY = REASONS["outside"], REASONS["facing_away"]
NO_PIXEL, OVERDRAWN = REASONS["no_pixel"], REASONS["overdrawn"]


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


@cached_njit(parallel=True, error_model="numpy")
def project_blocks(points: Any, blocks: Any, camera: Any, look: Any, slots: Any) -> None:
    """Project the visible blocks, chunk by chunk, each into its own slots.

    Tuples of arrays are unpacked before the loops: inside, numba would count references for every
    point.
    """
    bounds, _, cuts, turns, kept = blocks
    own_doubles, own_floats, own_bytes = points
    rules, shades, material_shift = look
    floats, bits, doubles, starts, stops, limits, reasons, nearest = slots
    inverse_focal = 1.0 / camera.focal
    for turn in nb.prange(len(turns)):
        chunk = turns[turn]
        first = starts[chunk]
        at = first
        rivals = nearest[nb.get_thread_id()]
        low, high = np.inf, -np.inf
        tally = np.zeros(reasons.shape[1], np.int64)
        block, at_border = -1, False
        begin = BLOCK_POINTS * cuts[chunk]
        end = begin + reasons[chunk, 0]
        for k in range(begin, end):
            i = kept[k]
            ahead = kept[min(k + AHEAD, end - 1)]
            if ahead - i > AHEAD:  # else the processor itself reads on
                prefetch_point(own_doubles, ahead)
            thin, two_sided = own_bytes[i, THIN] != 0, own_bytes[i, TWO_SIDED] != 0
            if i >> BLOCK_BITS != block:
                block = i >> BLOCK_BITS
                bound = bounds[block]
                at_border = rules[OUTSIDE] and not lies_inside(
                    bound, middle_of(bound, camera), camera
                )
            x, y, z = from_eye(camera, own_doubles[i, 0], own_doubles[i, 1], own_doubles[i, 2])
            may_miss = rules[NO_PIXEL] and not thin
            reason, image = project_disc(
                x, y, z, own_doubles[i, RADIUS], camera, may_miss, at_border
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
            normal = own_floats[i, NORMAL], own_floats[i, NORMAL + 1], own_floats[i, NORMAL + 2]
            reason, facing, nx, ny, nz = turn_to_eye(
                normal, two_sided, thin, image, camera, rules[FACING_AWAY]
            )
            slope_x, slope_y = np.float32(nx / facing), np.float32(ny / facing)
            column, line, radius = image.column, image.line, image.radius
            if (
                reason == 0
                and tiny
                and (alone or thin)
                and not _covers(image, a, b, slope_x, slope_y)
            ):
                if thin:
                    # The pixel that it lies in.
                    column, line = math.floor(column) + 0.5, math.floor(line) + 0.5
                    radius = max(radius, SMALLEST)
                    slope_x = slope_y = np.float32(0.0)
                else:
                    reason, alone = NO_PIXEL if rules[NO_PIXEL] else 0, False
            if reason != 0:
                tally[reason] += 1
                continue
            low, high = min(low, z), max(high, z)
            replaces = alone and rival != NO_RIVAL
            slot = rival if replaces else at
            at += not replaces
            tally[OVERDRAWN] += replaces
            if alone:
                rivals[place] = slot
            shade = shade_of(nx, ny, nz, facing, image, shades)
            floats[slot, COLUMN], floats[slot, LINE] = column, line
            floats[slot, DIAMETER] = 2.0 * radius
            floats[slot, SLOPE_X], floats[slot, SLOPE_Y] = slope_x, slope_y
            bits[slot, LOOK] = shade | np.uint32(own_bytes[i, MATERIAL]) << np.uint32(
                material_shift
            )
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
def _covers(image: Any, a: float, b: float, slope_x: float, slope_y: float) -> bool:
    """Return whether a tiny splat covers the centre of its own pixel."""
    form = conic(a, b, np.float64(slope_x), np.float64(slope_y))
    radius = image.radius if image.radius > SMALLEST else SMALLEST
    return covers_own_pixel(image.column, image.line, radius * radius, form)
