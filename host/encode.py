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
from .exact import conic, encode_exact, one_fraction, quantised_depth
from .project import Splats
from .quality import DEFAULT_QUALITY, QUALITIES
from .shapes import level_slopes, quantise, shape_table
from .symmetric import encode_symmetric
from .view import View

__all__ = ["Encoded", "encode"]

SMALLEST = 1e-3
"""Radius in pixels below which a splat's size makes no difference; its conic stays finite."""


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
    starts, stops
        The slots of each chunk: shape (chunks,), int64.
    counts
        Words of each chunk on each line: shape (chunks, lines), int32.
    elements
        Splats that gave at least one word.
    """

    words: npt.NDArray[np.uint64]
    lines: npt.NDArray[np.int16]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int32]
    elements: int

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
    _encode(source, fixed, to, starts, stops, counts, elements)
    return Encoded(words, lines, starts[:-1], stops, counts, int(elements.sum()))


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
    source: Any, fixed: Any, to: Any, starts: Any, stops: Any, counts: Any, elements: Any
) -> None:
    """Encode each chunk into its own slots, and count its words on each line.

    The outputs are arguments of their own: numba drops what is written to arrays out of a tuple
    that holds several of one type.
    """
    data, begins, ends = source
    words, lines, width, height, x_lsb, z_lsb, largest = to
    quality, inverse_focal, low, inverse_span = fixed[2], fixed[5], fixed[6], fixed[7]
    nearest_pixel, look_lsb = fixed[8], fixed[9]
    for chunk in nb.prange(len(begins)):
        at = starts[chunk]
        drawn = 0
        for i in range(begins[chunk], ends[chunk]):
            splat = data[i]
            before = at
            column, line = float(splat.column), float(splat.line)
            a, b = (column - 0.5 * width) * inverse_focal, (line - 0.5 * height) * inverse_focal
            form = conic(a, b, float(splat.slope_x), float(splat.slope_y))
            radius = 0.5 * float(splat.diameter)
            radius = min(max(radius, SMALLEST), LARGEST)
            found = 2
            if quality:
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
            for word in range(before, at):
                counts[chunk, lines[word]] += 1
        stops[chunk] = at
        elements[chunk] = drawn


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
