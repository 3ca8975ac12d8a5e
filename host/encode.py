"""Encoding: from splats on the image to code words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..rtl.format import BLOCK, ROWS, EngineConfig
from .emit import LARGEST, ONE_PIXEL, emit
from .exact import conic, covers_own_pixel, encode_exact, one_fraction, quantised_depth
from .occlusion import cover, is_hidden, new_pyramid
from .project import Splats
from .quality import DEFAULT_QUALITY, QUALITIES
from .shapes import level_slopes, quantise, shape_table
from .symmetric import encode_symmetric
from .view import View

__all__ = ["Encoded", "encode"]

SMALLEST = 1e-3
"""Radius in pixels below which a splat's size makes no difference; its conic stays finite."""


WAVES = 4
"""Parts that are encoded one after the other where each may hide the next."""

REACH = 0.5 * BLOCK + 1.0
"""Pixels by which a symmetric shape may reach beyond its true circle: so thin a one that it covers
no pixel's centre has the nearest in its own metric, anywhere in its block, from a whole place."""

TINY = 1.0 / float(np.finfo(np.float64).max)
"""Depth range up to which its inverse overflows."""


@dataclass(frozen=True)
class Encoded:
    """Code words in the order of their splats, before sorting: in chunks, with gaps between.

    Parameters
    ----------
    words
        Shape (slots,), uint64.
    lines
        The engine's line that each is meant for: shape (slots,), int16.
    turns
        When each has its turn among the words of its line: shape (slots,), uint8.
    starts, stops
        The slots of each chunk: shape (chunks,), int64.
    counts
        Words of each chunk on each line: shape (chunks, lines), int32.
    elements
        Splats that gave at least one word.
    hidden
        Splats left out as they are behind others.
    """

    words: npt.NDArray[np.uint64]
    lines: npt.NDArray[np.int16]
    turns: npt.NDArray[np.uint8]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int32]
    elements: int
    hidden: int = 0

    def together(self) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.int16]]:
        """Return words and lines without gaps."""
        parts = [slice(start, stop) for start, stop in zip(self.starts, self.stops, strict=True)]
        words = np.concatenate([self.words[part] for part in parts])
        return words, np.concatenate([self.lines[part] for part in parts])


def encode(
    splats: Splats,
    view: View,
    config: EngineConfig,
    quality: str = DEFAULT_QUALITY,
    *,
    nearest_pixel: bool = False,
    skip_hidden: bool = False,
) -> Encoded:
    """Return the code words that draw splats.

    Words that no pixel of the image needs are left out; those that cross the right or lower border
    are left to the engine. Depths are linear over the range that the splats' centres span: the
    nearest is 0, the furthest the largest that draws.

    Parameters
    ----------
    splats
        What to draw.
    view
        Size of the image, and its focal length.
    config
        Where the fields are.
    quality
        One of ``QUALITIES``.
    nearest_pixel
        Draw a splat that covers no pixel's centre as the pixel that holds it; else leave it out.
        The symmetric shapes always have a pixel.
    skip_hidden
        Leave out splats that are wholly behind others; no pixel changes by it.
    """
    low, high = splats.depth_range
    fixed = (
        shape_table(),
        level_slopes(),
        list(QUALITIES).index(quality),
        view.width,
        view.height,
        1.0 / view.focal,
        low,
        _inverse(high - low),
        nearest_pixel,
        config.diffuse.lsb,
    )
    chunks = len(splats.starts)
    room = np.empty(chunks, np.int64)
    source = (splats.data, splats.starts, splats.stops)
    _measure(source, fixed, room)
    starts = np.concatenate([[0], np.cumsum(room)])
    words = np.empty(starts[-1], np.uint64)
    lines = np.empty(starts[-1], np.int16)
    turns = np.empty(starts[-1], np.uint8)
    stops = np.empty(chunks, np.int64)
    counts = np.zeros((chunks, view.height + ROWS), np.int32)
    elements = np.empty(chunks, np.int64)
    to = (
        words,
        lines,
        view.width,
        view.height,
        config.x.lsb,
        config.z.lsb,
        config.background_depth - 1,
    )
    hidden = np.zeros(chunks, np.int64)
    pyramid = new_pyramid(view.width, view.height, config)
    depths = pyramid.bound, pyramid.coarse
    # Chunks that may hide others go first, and what they hide is known to those that follow.
    nearest = np.argsort(splats.nearest, kind="stable")
    for wave in np.array_split(nearest, WAVES) if skip_hidden else [nearest]:
        _encode(
            wave,
            source,
            fixed,
            to,
            skip_hidden,
            depths,
            turns,
            starts,
            stops,
            counts,
            elements,
            hidden,
        )
        if skip_hidden:
            cover(pyramid, words, lines, starts[wave], stops[wave], config)
    return Encoded(
        words, lines, turns, starts[:-1], stops, counts, int(elements.sum()), int(hidden.sum())
    )


def _inverse(span: float) -> float:
    """Return the inverse of a depth range; 0 for one so small that there is none."""
    return 1.0 / span if span > TINY else 0.0


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _measure(source: Any, fixed: Any, room: Any) -> None:
    """Set how many words each chunk has at the most."""
    data, starts, stops = source
    for chunk in nb.prange(len(starts)):
        total = 0
        for i in range(starts[chunk], stops[chunk]):
            total += _room(data[i], fixed)
        room[chunk] = total


@nb.njit(error_model="numpy")
def _room(splat: Any, fixed: Any) -> int:
    """Return the most words that a splat may take.

    A disc seen at the slant a = x / z reaches sqrt(1 + a^2) times its radius (see ``conic``), and
    2 r pixels hold the centres of at most floor(2 r) + 1. The symmetric shapes reach a pixel
    further, for their whole places and diameters.
    """
    quality, width, height, inverse_focal = fixed[2], fixed[3], fixed[4], fixed[5]
    diameter = float(splat.diameter)
    if quality < 2 and diameter <= BLOCK:
        return 2
    a, b = abs(splat.column - 0.5 * width), abs(splat.line - 0.5 * height)
    a, b = a * inverse_focal, b * inverse_focal
    wide = diameter * (1.0 + min(a, 0.5 * a * a)) + 1e-3
    high = diameter * (1.0 + min(b, 0.5 * b * b)) + 1e-3
    if quality == 0:
        wide, high = wide + 2.0 * ROWS, high + 4.0 * ROWS
    lines = min(int(min(high, LARGEST)) + 1, height + 2 * ROWS)
    columns = min(int(min(wide, LARGEST)) + 1, width + BLOCK)
    return -(-lines // ROWS) * -(-columns // BLOCK)


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _encode(
    wave: Any,
    source: Any,
    fixed: Any,
    to: Any,
    skip_hidden: bool,
    depths: Any,
    turns: Any,
    starts: Any,
    stops: Any,
    counts: Any,
    elements: Any,
    hidden: Any,
) -> None:
    """Encode each chunk into its own slots, and count its words on each line.

    The outputs are arguments of their own: numba drops what is written to arrays out of a tuple
    that holds several of one type.
    """
    data, begins, ends = source
    words, lines, width, height, x_lsb, z_lsb, largest = to
    quality, inverse_focal, low, inverse_span = fixed[2], fixed[5], fixed[6], fixed[7]
    nearest_pixel, look_lsb = fixed[8], fixed[9]
    bound, coarse = depths
    for number in nb.prange(len(wave)):
        chunk = wave[number]
        at = starts[chunk]
        drawn, behind = 0, 0
        for i in range(begins[chunk], ends[chunk]):
            splat = data[i]
            before = at
            column, line = float(splat.column), float(splat.line)
            a, b = (column - 0.5 * width) * inverse_focal, (line - 0.5 * height) * inverse_focal
            form = conic(a, b, float(splat.slope_x), float(splat.slope_y))
            radius = 0.5 * float(splat.diameter)
            radius = min(max(radius, SMALLEST), LARGEST)
            if skip_hidden and _is_hidden(splat, radius, a, b, fixed, largest, bound, coarse):
                behind += 1
                continue
            found = 2
            if quality and radius * (1.0 + 0.5 * (a * a + b * b)) < 0.5:
                # No other pixel's centre is near enough.
                found, scans = int(covers_own_pixel(column, line, radius * radius, form)), ONE_PIXEL
                x, top = math.floor(column), math.floor(line)
                found = found if 0 <= x < width and 0 <= top < height else 0
            elif quality:
                found, x, top, scans = one_fraction(
                    column, line, radius * radius, form, width, height
                )
            if found == 1:  # nearly all
                depth = quantised_depth((splat.depth - low) * inverse_span, largest)
                common = np.int64(splat.look) << look_lsb | depth << z_lsb
                words[at] = common | 1 | scans << 1 | x << x_lsb
                lines[at] = top + ROWS
                at += 1
            elif found == 2 or nearest_pixel:
                at = _encode_other(splat, found, form, fixed, at, to)
            drawn += at > before
            turn = _turn(column, line)
            for word in range(before, at):
                turns[word] = turn
                counts[chunk, lines[word]] += 1
        stops[chunk] = at
        elements[chunk] = drawn
        hidden[chunk] = behind


@nb.njit(inline="always")
def _turn(column: float, line: float) -> int:
    """Return when a splat has its turn on its line, as good as at random, from its place alone.

    So the order of two words does not depend on which others there are, nor on the order of the
    points. (Multipliers of Fibonacci hashing and of xxHash.)
    """
    across, down = int(column * 1024.0), int(line * 1024.0)
    return (across * 0x9E3779B1 + down * 0x85EBCA77) >> 24 & 255


@nb.njit(error_model="numpy")
def _is_hidden(
    splat: Any, radius: float, a: float, b: float, fixed: Any, largest: int, bound: Any, coarse: Any
) -> bool:
    """Return whether none of a splat can be seen, however its words turn out.

    Parameters
    ----------
    radius
        In pixels.
    a, b
        Where its centre lies: x / z and y / z.
    """
    inverse_focal, low, inverse_span = fixed[5], fixed[6], fixed[7]
    # As far as its disc reaches (see ``conic``), or its symmetric shape.
    beyond = 0.01 if fixed[2] == 2 else REACH
    wide = radius * (1.0 + min(abs(a), 0.5 * a * a)) + beyond
    high = radius * (1.0 + min(abs(b), 0.5 * b * b)) + beyond
    # The disc's plane is nearest at a corner of that.
    change = splat.depth * inverse_span * inverse_focal
    nearer = change * (abs(splat.slope_x) * wide + abs(splat.slope_y) * high)
    depth = (splat.depth - low) * inverse_span
    z = quantised_depth(depth - nearer if radius > 0.5 * ROWS - 1.0 else depth, largest)
    return is_hidden(splat.column, splat.line, wide, high, z, bound, coarse)


@nb.njit(error_model="numpy")
def _encode_other(splat: Any, found: int, form: Any, fixed: Any, at: int, to: Any) -> int:
    """Write the words of a splat that is not one fraction, and return the next one's place."""
    table, levels, quality, _, _, inverse_focal, low, inverse_span, nearest_pixel, look_lsb = fixed
    z_lsb, largest = to[5], to[6]
    column, line, diameter = float(splat.column), float(splat.line), float(splat.diameter)
    slope_x, slope_y = float(splat.slope_x), float(splat.slope_y)
    common = np.int64(splat.look) << look_lsb
    depth = (splat.depth - low) * inverse_span
    if quality == 0 or (found and quality == 1 and diameter <= BLOCK):
        shape = quantise(-slope_x, -1.0), quantise(-slope_y, -1.0)
        common |= quantised_depth(depth, largest) << z_lsb
        return encode_symmetric(column, line, diameter, shape, table, levels, common, at, to)
    if found:
        # From a pixel to the next the plane's depth changes by -n' z / focal.
        change = -splat.depth * inverse_span * inverse_focal
        plane = depth, slope_x * change, slope_y * change
        radius = min(max(0.5 * diameter, SMALLEST), LARGEST)
        end = encode_exact(column, line, radius * radius, form, plane, common, at, to)
        if end > at or not nearest_pixel:
            return end
    common |= quantised_depth(depth, largest) << z_lsb
    return emit(ONE_PIXEL, math.floor(column), math.floor(line), common, at, to)
