"""The compiled loop over splats: each becomes one fraction, or the words of its quality."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.config import BLOCK, ROWS
from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.normal_levels import LEVELS, quantise_slopes
from splatline.host.visibility.footprint import (
    FLAT,
    SMALLEST,
    conic,
    covers_own_pixel,
    is_tiny,
)
from splatline.host.visibility.occlusion import is_hidden
from splatline.host.visibility.splats import COLUMN, DEPTH, DIAMETER, LINE, LOOK, SLOPE_X, SLOPE_Y
from splatline.host.visibility.view import LARGEST

from .compact_words import encode_compact
from .ellipse import in_perspective, one_fraction
from .half_pixel import encode_half_pixel, fits_block
from .large_splats import STEEP, covers_some, encode_fractions, fraction_size
from .paper_shapes import encode_symmetric
from .quality import AS_PAPER, EXACT, FAST
from .tile import Tile, may_touch
from .write_words import ONE_PIXEL, quantised_depth, write_fraction

__all__ = [
    "DRAWN",
    "HIDDEN",
    "Fixed",
    "Occluders",
    "Slots",
    "encode_splats",
    "measure_room",
    "own_pixel",
]

SMALL = 2.0
"""Diameter in pixels of a splat that takes one word unless it is near the eye or far aslant."""

REACH = 0.5 * BLOCK + 1.0
"""Pixels by which a symmetric shape may reach beyond its circle. A shape that covers no pixel's
centre has the nearest pixel in its own metric, which may lie anywhere in its block."""


DRAWN, HIDDEN = 1, 2
"""Marks of splats that gave a word, and of those that are behind others."""


class Fixed(NamedTuple):
    """Values that are the same for all splats of a frame.

    Parameters
    ----------
    quality
        Its number.
    inverse_focal
        1 over the focal length, in pixels.
    low, inverse_span
        The least depth, and 1 over the range of depths.
    nearest_pixel
        Whether a splat without a pixel draws the nearest.
    look_lsb
        The lowest bit of DIFFUSE.
    near
        Distance of the near plane.
    middle_x, middle_y
        Column and line of the view's axis.
    """

    quality: int
    inverse_focal: float
    low: float
    inverse_span: float
    nearest_pixel: bool
    look_lsb: int
    near: float
    middle_x: float
    middle_y: float


class Shapes(NamedTuple):
    """The shapes of the quality ``paper``.

    Parameters
    ----------
    table, levels
        The shape table, and the slopes of its levels.
    largest_compact
        The largest size that becomes a compact word; 0: none.
    """

    table: Any
    levels: Any
    largest_compact: int


@cached_njit(parallel=True, error_model="numpy")
def measure_room(source: Any, fixed: Any, size: Any, inside: Any, room: Any) -> None:
    """Set the slots that each chunk needs: for the most words that it may have, and one more.

    Parameters
    ----------
    source, fixed
        As for :func:`encode_splats`.
    size, inside
        Columns and lines of the whole image, and of the tile.
    room
        Set: shape (chunks,), int64.
    """
    floats, _, doubles, starts, stops = source
    for chunk in nb.prange(len(starts)):
        total = 1  # where a word goes that does not touch the tile
        for i in range(starts[chunk], stops[chunk]):
            position = floats[i, COLUMN], floats[i, LINE]
            slope = floats[i, SLOPE_X], floats[i, SLOPE_Y]
            total += _room(
                position, floats[i, DIAMETER], slope, doubles[i, DEPTH], fixed, size, inside
            )
        room[chunk] = total


@nb.njit(error_model="numpy")
def _room(
    position: Any, diameter: float, slope: Any, distance: float, fixed: Any, size: Any, inside: Any
) -> int:
    """Return the most words that a splat may take.

    A disc seen at the slant a = x / z reaches sqrt(1 + a^2) times its radius (see ``conic``), and
    2 r pixels hold the centres of at most floor(2 r) + 1. Symmetric shapes reach a pixel further,
    as their positions and diameters are whole.
    """
    inverse_focal = fixed.inverse_focal
    if fixed.quality != EXACT and diameter <= BLOCK:
        return 2
    a, b = abs(position[0] - fixed.middle_x), abs(position[1] - fixed.middle_y)
    a, b = a * inverse_focal, b * inverse_focal
    if diameter <= SMALL and max(a, b) <= 1.0 and diameter * inverse_focal <= 0.2:
        return 1  # 2 (1 + 1 / 2) / (1 - 0.1) is below 4; nearly all of a dense cloud
    # As in ``cull.lies_outside``. A disc that comes nearer than half the distance may fill the
    # image.
    share = 0.5 * diameter * inverse_focal
    larger = 1.0 / (1.0 - share) if share < 0.5 else LARGEST
    wide = diameter * (1.0 + min(a, 0.5 * a * a)) * larger + 1e-3
    high = diameter * (1.0 + min(b, 0.5 * b * b)) * larger + 1e-3
    if fixed.quality == AS_PAPER:
        wide, high = wide + 2.0 * ROWS, high + 4.0 * ROWS
    lines = min(int(min(high, LARGEST)) + 1, size[1] + 2 * ROWS)
    columns = min(int(min(wide, LARGEST)) + 1, size[0] + BLOCK)
    if lines <= ROWS and columns <= BLOCK:
        return 1
    # Computed as in ``encode_fractions``, to the last bit.
    change = distance * fixed.inverse_span
    change_x = float(slope[0]) * inverse_focal * change
    change_y = float(slope[1]) * inverse_focal * change
    most_columns, most_lines = fraction_size(
        change_x, change_y, STEEP if fixed.quality == EXACT else math.inf
    )
    return _parts(lines, most_lines, inside[1]) * _parts(columns, most_columns, inside[0])


@nb.njit(inline="always")
def _parts(length: int, most: int, inside: int) -> int:
    """Return the most parts of a splat that touch a tile.

    A splat has as few parts as can be, so that each but the border's has more than half of ``most``
    lines or columns; see ``large_splats.cut``.

    Parameters
    ----------
    length, most
        Lines or columns of the splat, and the most that a part has.
    inside
        Lines or columns of the tile.
    """
    return min(-(-length // most), inside // (most // 2 + 1) + 2)


class Occluders(NamedTuple):
    """The depth pyramid that hides splats.

    Parameters
    ----------
    are_used
        Whether hidden splats are left out.
    bound, coarse
        See ``host.visibility.occlusion.Pyramid``.
    """

    are_used: bool
    bound: Any
    coarse: Any


class Slots(NamedTuple):
    """The results of :func:`encode_splats` beside the words; see ``Encoded``.

    Parameters
    ----------
    starts
        First slot of each chunk.
    stops, counts, elements, hidden
        Set; ``elements`` and ``hidden`` for each chunk.
    marks
        Set for each slot of a splat that is drawn or hidden: ``DRAWN`` or ``HIDDEN``. Empty: not
        asked for.
    """

    starts: Any
    stops: Any
    counts: Any
    elements: Any
    hidden: Any
    marks: Any

    @classmethod
    def of(cls, starts: Any, tile: Tile, marks: Any) -> Slots:
        """Return slots in which nothing is counted yet."""
        chunks = len(starts)
        return cls(
            starts=starts,
            stops=np.empty(chunks, np.int64),
            counts=np.zeros((chunks, tile.size[1] + ROWS), np.int32),
            elements=np.empty(chunks, np.int64),
            hidden=np.zeros(chunks, np.int64),
            marks=marks,
        )


@cached_njit(parallel=True, error_model="numpy")
def encode_splats(
    wave: Any, source: Any, fixed: Any, shapes: Any, to: Any, occluders: Any, slots: Any
) -> None:
    """Encode chunks, each into its own slots, and count their words on each line.

    Parameters
    ----------
    wave
        Numbers of the chunks.
    source
        Views of the splats (see ``Splats.views``), and the slots of each chunk.
    fixed, shapes
        See :class:`Fixed` and :class:`Shapes`.
    to
        Where words go; see :class:`splatline.host.encode.tile.Target`.
    occluders, slots
        See :class:`Occluders` and :class:`Slots`.
    """
    floats, bits, doubles, begins, ends = source
    words, lines, width, height = to.words, to.lines, to.width, to.height
    x_lsb, z_lsb, largest = to.x_lsb, to.z_lsb, to.largest
    border, bottom = to.right, to.bottom
    origin_x, origin_y = origin = to.origin_x, to.origin_y
    skip_hidden, bound, coarse = occluders
    starts, stops, counts, elements, hidden, marks = slots
    marked = len(marks) > 0
    # Read before the loop, which would read them again for every splat.
    inverse_focal, low, inverse_span = fixed.inverse_focal, fixed.low, fixed.inverse_span
    look_lsb, nearest_pixel = fixed.look_lsb, fixed.nearest_pixel
    middle_x, middle_y = fixed.middle_x, fixed.middle_y
    true_shapes = fixed.quality != AS_PAPER
    table, levels, largest_compact = shapes
    for number in nb.prange(len(wave)):
        chunk = wave[number]
        at = starts[chunk]
        drawn, behind = 0, 0
        for i in range(begins[chunk], ends[chunk]):
            before = at
            column, line = float(floats[i, COLUMN]), float(floats[i, LINE])
            slope_x, slope_y = float(floats[i, SLOPE_X]), float(floats[i, SLOPE_Y])
            diameter, distance = float(floats[i, DIAMETER]), doubles[i, DEPTH]
            a = (column - middle_x) * inverse_focal
            b = (line - middle_y) * inverse_focal
            form = conic(a, b, slope_x, slope_y)
            # A size far below a pixel or beyond any image makes no difference.
            radius = 0.5 * diameter
            radius = radius if radius > SMALLEST else SMALLEST
            radius = radius if radius < LARGEST else LARGEST
            square = radius * radius
            in_depth = true_shapes and square * inverse_focal > FLAT
            splat = column, line, diameter, slope_x, slope_y, distance
            if (
                skip_hidden
                and not in_depth
                and _is_hidden(splat, origin, radius, a, b, fixed, largest, bound, coarse)
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
            if true_shapes and is_tiny(radius, a, b, inverse_focal):
                # No other pixel's centre is near enough.
                found, x, top = own_pixel(column, line, square, form, width, height)
                scans = ONE_PIXEL
            elif true_shapes and radius * inverse_focal < 0.5:
                found, x, top, scans = one_fraction(centre_x, centre_y, square, form, width, height)
            if found == 1:  # nearly all
                z = quantised_depth((distance - low) * inverse_span, largest)
                common = np.int64(bits[i, LOOK]) << look_lsb | z << z_lsb
                words[at] = common | 1 | scans << 1 | x - origin_x << x_lsb
                lines[at] = top + ROWS - origin_y
                at += may_touch(x, top + ROWS, origin_x, origin_y, border, bottom)
            elif not true_shapes:
                z = quantised_depth((distance - low) * inverse_span, largest)
                common = np.int64(bits[i, LOOK]) << look_lsb | z << z_lsb
                shape = quantise_slopes(slope_x, slope_y, LEVELS)
                if largest_compact > 0:
                    at = encode_compact(
                        column, line, diameter, shape, largest_compact, table, levels, common, at,
                        to,
                    )  # fmt: skip
                else:
                    at = encode_symmetric(
                        column, line, diameter, shape, table, levels, common, at, to
                    )
            elif found == 2 or nearest_pixel:
                common = np.int64(bits[i, LOOK]) << look_lsb
                share = radius * inverse_focal
                ellipse = centre_x, centre_y, square, share * share
                at = _encode_other(splat, common, found, form, ellipse, fixed, at, to)
            drawn += at > before
            if marked and at > before:
                marks[i] = DRAWN
            for word in range(before, at):
                counts[chunk, lines[word]] += 1
        stops[chunk] = at
        elements[chunk] = drawn
        hidden[chunk] = behind


@nb.njit(inline="always")
def own_pixel(
    column: float, line: float, square: float, form: Any, width: int, height: int
) -> tuple[int, int, int]:
    """Return whether a splat covers its own pixel's centre in the image, and the pixel."""
    x, top = math.floor(column), math.floor(line)
    found = int(covers_own_pixel(column, line, square, form))
    return found if 0 <= x < width and 0 <= top < height else 0, x, top


@nb.njit(error_model="numpy")
def _is_hidden(
    splat: Any,
    origin: Any,
    radius: float,
    a: float,
    b: float,
    fixed: Any,
    largest: int,
    bound: Any,
    coarse: Any,
) -> bool:
    """Return whether a splat is hidden, whatever its words will be.

    Parameters
    ----------
    origin
        Column and line at which the pyramid begins.
    radius
        In pixels.
    a, b
        x / z and y / z of its centre.
    """
    column, line, _, slope_x, slope_y, distance = splat
    inverse_focal, low, inverse_span = fixed.inverse_focal, fixed.low, fixed.inverse_span
    # The reach of its disc (see ``conic``) or of its symmetric shape.
    beyond = 0.01 if fixed.quality == EXACT else REACH
    wide = radius * (1.0 + min(abs(a), 0.5 * a * a)) + beyond
    high = radius * (1.0 + min(abs(b), 0.5 * b * b)) + beyond
    # The disc's plane is nearest at a corner of that rectangle.
    change = distance * inverse_span * inverse_focal
    nearer = change * (abs(slope_x) * wide + abs(slope_y) * high)
    depth = (distance - low) * inverse_span
    z = quantised_depth(depth - nearer if radius > 0.5 * ROWS - 1.0 else depth, largest)
    return is_hidden(column - origin[0], line - origin[1], wide, high, z, bound, coarse)


@nb.njit(error_model="numpy")
def _encode_other(
    splat: Any,
    common: int,
    found: int,
    form: Any,
    ellipse: Any,
    fixed: Any,
    at: int,
    to: Any,
) -> int:
    """Write the words of a splat that is not one fraction; return the next slot."""
    quality = fixed.quality
    column, line, diameter, slope_x, slope_y, distance = splat
    z_lsb, largest = to.z_lsb, to.largest
    depth = (distance - fixed.low) * fixed.inverse_span
    if (
        found
        and quality == FAST
        and (diameter <= BLOCK or fits_block(ellipse[0], ellipse[1], ellipse[2], form))
    ):
        common |= quantised_depth(depth, largest) << z_lsb
        return encode_half_pixel(ellipse[0], ellipse[1], ellipse[2], form, common, at, to)
    if found:
        plane = (
            column,
            line,
            slope_x * fixed.inverse_focal,
            slope_y * fixed.inverse_focal,
            distance,
            fixed.low,
            fixed.inverse_span,
            ellipse[3],
            fixed.near,
            STEEP if quality == EXACT else math.inf,
        )
        end = encode_fractions(ellipse[0], ellipse[1], ellipse[2], form, plane, common, at, to)
        if (
            end > at
            or not fixed.nearest_pixel
            or covers_some(ellipse[0], ellipse[1], ellipse[2], form, plane, to.width, to.height)
        ):
            return end
    common |= quantised_depth(depth, largest) << z_lsb
    return write_fraction(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
