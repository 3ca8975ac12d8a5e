"""Encoding: from splats on the image to code words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..rtl.format import BLOCK, ROWS, EngineConfig
from .project import Splats
from .shapes import EMPTY_SCANS, LEVELS, SIZES, level_slopes, row_span, shape_table

__all__ = ["Encoded", "depth_codes", "encode"]

LARGEST = float(1 << 24)
"""Pixels beyond which a coordinate is far outside every image; exact in float32."""


@dataclass(frozen=True)
class Encoded:
    """Code words in the order of their splats, before sorting.

    Parameters
    ----------
    words
        Shape (n,), uint64.
    lines
        The engine's line that each is meant for: shape (n,), int16.
    elements
        Splats that gave at least one word.
    """

    words: npt.NDArray[np.uint64]
    lines: npt.NDArray[np.int16]
    elements: int


def depth_codes(
    depth: npt.NDArray[np.float64], config: EngineConfig
) -> tuple[npt.NDArray[np.uint16], tuple[float, float]]:
    """Return quantised depths, and the range that code 0 and the largest code stand for.

    Linear, fitted to the splats at hand; the largest value of all stays the background's.
    """
    if not len(depth):
        return np.zeros(0, np.uint16), (0.0, 0.0)
    low, high = float(depth.min()), float(depth.max())
    largest = config.background_depth - 1
    span = high - low
    if span == 0.0:
        return np.zeros(len(depth), np.uint16), (low, high)
    # Dividing first keeps the product finite whatever the cloud's unit.
    return np.rint((depth - low) / span * largest).astype(np.uint16), (low, high)


def encode(
    splats: Splats,
    z: npt.NDArray[np.uint16],
    diffuse: npt.NDArray[np.uint16],
    specular: npt.NDArray[np.uint16],
    material: npt.NDArray[np.uint8],
    width: int,
    height: int,
    config: EngineConfig,
) -> Encoded:
    """Return the code words that draw splats at whole-pixel places and whole diameters.

    Diameters are rounded up: about a pixel corner a disc of 3 pixels covers no more than one of 2,
    and rounding to nearest left three to ten times the holes (``docs/decisions.md``).

    - Diameters up to 1 pixel: the pixel that holds the centre, one fraction (MODE 1).
    - Up to 8: the shape table's block, its middle at the pixel corner nearest to the centre, one
      symmetric word (MODE 0); as two fractions where it crosses the upper or left border.
    - Above: fractions of 8 x 4 pixels, from the table up to 16 and from the ellipse itself beyond;
      one that covers no pixel's centre draws the pixel that holds its own.

    Words that no pixel of the image needs are left out; those that cross the right or lower border
    are left to the engine.

    Parameters
    ----------
    splats
        What to draw.
    z, diffuse, specular, material
        Fields of each splat: shape (m,).
    width, height
        Of the image.
    config
        Where the fields are.
    """
    common = z.astype(np.uint64) << np.uint64(config.z.lsb)
    common |= material.astype(np.uint64) << np.uint64(config.material.lsb)
    common |= specular.astype(np.uint64) << np.uint64(config.specular.lsb)
    common |= diffuse.astype(np.uint64) << np.uint64(config.diffuse.lsb)
    geometry = (splats.column, splats.line, splats.diameter, splats.shape)
    fixed = (shape_table(), level_slopes(), width, height, config.x.lsb)

    # Every chunk of splats counts its words, then writes them to its own part: the same words in
    # the same order, however many cores there are.
    count = len(splats)
    bounds = np.linspace(0, count, 65).astype(np.int64)
    nothing = np.zeros(0, np.uint64), np.zeros(0, np.int16)
    starts = np.zeros(len(bounds), np.int64)
    elements = np.zeros(len(bounds), np.int64)
    _encode_chunks(*geometry, common, *fixed, bounds, starts, elements, *nothing, False)
    starts = np.concatenate([[0], np.cumsum(starts[:-1])])
    words = np.empty(starts[-1], np.uint64)
    lines = np.empty(starts[-1], np.int16)
    _encode_chunks(*geometry, common, *fixed, bounds, starts, elements, words, lines, True)
    return Encoded(words, lines, int(elements.sum()))


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _encode_chunks(
    column: Any,
    line: Any,
    diameter: Any,
    shape: Any,
    common: Any,
    table: Any,
    slopes: Any,
    width: int,
    height: int,
    x_lsb: int,
    bounds: Any,
    starts: Any,
    elements: Any,
    words: Any,
    lines: Any,
    write: bool,
) -> None:
    """Encode each chunk: count its words into ``starts`` or, with ``write``, write from there."""
    for chunk in nb.prange(len(bounds) - 1):
        at = starts[chunk] if write else 0
        drawn = 0
        for i in range(bounds[chunk], bounds[chunk + 1]):
            before = at
            at = _encode_one(
                column[i],
                line[i],
                diameter[i],
                shape[i],
                common[i],
                table,
                slopes,
                at,
                words,
                lines,
                width,
                height,
                x_lsb,
                write,
            )
            drawn += at > before
        elements[chunk] = drawn
        if not write:
            starts[chunk] = at


@nb.njit
def _encode_one(
    column: float,
    line: float,
    diameter: float,
    shape: int,
    common: int,
    table: Any,
    slopes: Any,
    at: int,
    words: Any,
    lines: Any,
    width: int,
    height: int,
    x_lsb: int,
    write: bool,
) -> int:
    """Write a splat's words from ``at`` on, and return where the next splat's begin."""
    to = (words, lines, width, height, x_lsb, write)
    size = math.ceil(min(diameter, 2.0 * LARGEST))
    if size <= 1:
        return _emit(EMPTY_SCANS & ~63, math.floor(column), math.floor(line), common, at, to)

    x = math.floor(column + 0.5)
    y = math.floor(line + 0.5)
    level_x, level_y = shape // LEVELS, shape % LEVELS
    if size <= BLOCK:
        scans = int(table[size, level_x, level_y, 0])
        x -= BLOCK // 2
        if x >= 0 and y >= 0:
            if x >= width or y - ROWS >= height:
                return at
            return _put(common | scans << 1 | x << x_lsb, y, at, to)
        at = _emit(scans, x, y - ROWS, common, at, to)
        return _emit(_turned(scans), x, y, common, at, to)

    if size < SIZES:
        upper = table[size, level_x, level_y]
        x -= BLOCK
        for fraction in range(4):
            scans = int(upper[fraction])
            dx, dy = BLOCK * (fraction % 2), ROWS * (fraction // 2)
            at = _emit(scans, x + dx, y - 2 * ROWS + dy, common, at, to)
            at = _emit(_turned(scans), x + BLOCK - dx, y + ROWS - dy, common, at, to)
        return at
    end = _encode_large(x, y, 0.5 * size, slopes[level_x], slopes[level_y], common, at, to)
    if end == at:  # so thin that it covers no pixel's centre
        return _emit(EMPTY_SCANS & ~63, math.floor(column), math.floor(line), common, at, to)
    return end


@nb.njit
def _encode_large(
    x: int, y: int, radius: float, slope_x: float, slope_y: float, common: int, at: int, to: Any
) -> int:
    """Write the fractions of an ellipse of any size about the pixel corner (x, y)."""
    _, _, width, height, _, _ = to
    # Only the blocks that reach into the image, however large the ellipse is.
    blocks = math.ceil(min(radius, 4.0 * (abs(y) + height)) / ROWS)
    begin_block = max(-blocks, -(y // ROWS) - 1)
    end_block = min(blocks, (height - y) // ROWS + 1)
    for block in range(begin_block, end_block):
        top = y + ROWS * block
        if top >= height or top + ROWS <= 0:
            continue
        left, right = _block_extent(block, radius, slope_x, slope_y)
        first_column = max(x + left, 0)
        last_column = min(x + right, width - 1)
        for begin in range(first_column, last_column + 1, BLOCK):
            scans = 0
            for row in range(ROWS):
                a, b = _row_pixels(block, row, radius, slope_x, slope_y)
                first = max(x + a - begin, 0)
                last = min(x + b - begin, BLOCK - 1)
                filled = first <= last
                scans |= ((first | last << 3) if filled else 1) << 6 * row
            at = _emit(scans, begin, top, common, at, to)
    return at


@nb.njit
def _row_pixels(
    block: int, row: int, radius: float, slope_x: float, slope_y: float
) -> tuple[int, int]:
    """Return the first and last pixel, from the centre on, of a row of the ellipse."""
    left, right = row_span(ROWS * block + row + 0.5, slope_x, slope_y, radius)
    # An ellipse may be wider than an integer holds.
    left, right = max(left, -LARGEST), min(right, LARGEST)
    return math.ceil(left - 0.5), math.floor(right - 0.5)


@nb.njit
def _block_extent(block: int, radius: float, slope_x: float, slope_y: float) -> tuple[int, int]:
    """Return the first and last pixel of four rows together; first > last if all are empty."""
    left, right = 1 << 30, -(1 << 30)
    for row in range(ROWS):
        a, b = _row_pixels(block, row, radius, slope_x, slope_y)
        if a <= b:
            left, right = min(left, a), max(right, b)
    return left, right


@nb.njit
def _turned(scans: int) -> int:
    """Return four rows turned by 180 degrees: in reverse order, and each from right to left."""
    turned = 0
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        turned |= ((7 - last) | (7 - first) << 3) << 6 * (ROWS - 1 - row)
    return turned


@nb.njit
def _emit(scans: int, x: int, top: int, common: int, at: int, to: Any) -> int:
    """Write a fraction with its first row on line ``top``, clipped on the left; none if empty."""
    _, _, width, height, x_lsb, _ = to
    x, top = int(x), int(top)
    if x >= width or x <= -BLOCK or top >= height or top <= -ROWS:
        return at
    clipped = 0
    visible = False
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        if x < 0:
            first, last = max(first + x, 0), last + x
        if first <= last and 0 <= top + row < height and x + first < width:
            clipped |= (first | last << 3) << 6 * row
            visible = True
        else:
            clipped |= 1 << 6 * row
    if not visible:
        return at
    return _put(common | 1 | clipped << 1 | max(x, 0) << x_lsb, top + ROWS, at, to)


@nb.njit
def _put(word: int, line: int, at: int, to: Any) -> int:
    """Write a word, unless words are only being counted."""
    words, lines, _, _, _, write = to
    if write:
        words[at] = word
        lines[at] = line
    return at + 1
