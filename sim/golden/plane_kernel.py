"""The compiled loops of the golden renderer for plane words: a depth for every pixel.

It is written from ``docs/contract.md``, "Plane words", and shares with the hardware only the
positions of the fields. Lines, bands and the moving canvas are as in :mod:`.kernel`; a pixel of the
canvas holds its depth, and below it the look of the code word that drew it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION
from splatline.host.compiled_cache import cached_njit

from .kernel import ABOVE, BELOW, LANES, ROW_BITS, filled_rows, lowest_bit

__all__ = ["PlaneLayout", "draw_plane_bands", "plane_layout_of"]

DEPTH_LSB = 32
"""Lowest bit of a pixel's depth in the canvas. Below it lies the look of its code word, which
has at most 27 bits."""

LOOK_MASK = (1 << DEPTH_LSB) - 1
"""All ones: the look of a pixel that nothing was drawn into."""

FRACTIONS = SUM_FRACTION - Z_FRACTION
"""Bits by which Z is shifted left to have the fraction bits of the sum."""

SHIFT = np.array(SHIFTS, np.int64)

ONE = np.uint64(1)


class PlaneLayout(NamedTuple):
    """The bit positions of a configuration's fields, for the compiled loops.

    Those of the high half are counted from its own bit 0. ``slope_bits`` and ``z_bits`` are widths;
    ``look_bits`` is that of DIFFUSE, SPECULAR and MATERIAL together.
    """

    diffuse_lsb: int
    look_bits: int
    intensity_bits: int
    x_lsb: int
    x_bits: int
    side_lsb: int
    raised_lsb: int
    outwards_lsb: int
    slope_x_lsb: int
    slope_y_lsb: int
    slope_bits: int
    scale_lsb: int
    z_lsb: int
    z_bits: int
    background: int
    colour_shift: int
    channel_max: int


def plane_layout_of(config: EngineConfig) -> PlaneLayout:
    """Return the layout of a configuration with planes."""
    return PlaneLayout(
        diffuse_lsb=config.diffuse.lsb,
        look_bits=config.x.lsb - config.diffuse.lsb,
        intensity_bits=config.intensity_bits,
        x_lsb=config.x.lsb,
        x_bits=config.x.width,
        side_lsb=config.side(0, 0).lsb,
        raised_lsb=config.raised.lsb - LOW_BITS,
        outwards_lsb=config.outwards(0).lsb - LOW_BITS,
        slope_x_lsb=config.slope_x.lsb - LOW_BITS,
        slope_y_lsb=config.slope_y.lsb - LOW_BITS,
        slope_bits=config.slope_bits,
        scale_lsb=config.scale.lsb - LOW_BITS,
        z_lsb=config.z.lsb - LOW_BITS,
        z_bits=config.z.width,
        background=config.background_depth,
        colour_shift=config.colour_shift,
        channel_max=config.channel_max,
    )


@cached_njit(parallel=True)
def draw_plane_bands(
    words: Any,
    starts: Any,
    cuts: Any,
    ambient: Any,
    coefficients: Any,
    layout: PlaneLayout,
    depth: Any,
    colour: Any,
) -> None:
    """Draw a frame of plane words, its bands in parallel.

    Parameters
    ----------
    words
        Plane words, low half and high half: shape (n, 2), int64, the bits of unsigned ones.
    starts, cuts, ambient, coefficients, depth, colour
        As for :func:`splatline.sim.golden.kernel.draw_bands`.
    layout
        Bit positions of the fields.
    """
    width = depth.shape[1]
    for band in nb.prange(len(cuts) - 1):
        begin, end = cuts[band], cuts[band + 1]
        # A block may reach beyond the right border, and the vector of pixels tested beyond it.
        canvas = np.zeros((BLOCK, width + 2 * BLOCK), np.int64)
        for y in range(begin - BELOW, end + ABOVE):
            if y + BELOW < end:
                line = y + BELOW
                for column in range(width):
                    stored = np.int64(depth[line, column])
                    canvas[line % BLOCK, column] = stored << DEPTH_LSB | LOOK_MASK
            if y >= 0:
                for index in range(starts[y], starts[y + 1]):
                    low, high = words[index, 0], words[index, 1]
                    _draw_word(low, high, y, layout, canvas)
            if y - ABOVE >= begin:
                _close_line(canvas, y - ABOVE, ambient, coefficients, layout, depth, colour)


@cached_njit(inline="always")
def _bits(word: int, lsb: int, width: int) -> int:
    """Return the value of an unsigned field."""
    return word >> lsb & (1 << width) - 1


@nb.njit(inline="always")
def _inside(place: Any) -> Any:
    """Return the nearest column of a block."""
    return min(max(place, 0), BLOCK - 1)


@cached_njit()
def _draw_word(low: int, high: int, y: int, layout: PlaneLayout, canvas: Any) -> None:
    """Draw a code word into the canvas; a control word has no row and draws nothing."""
    x = _bits(low, layout.x_lsb, layout.x_bits)
    if x >= canvas.shape[1] - 2 * BLOCK:
        return
    shift = SHIFT[_bits(high, layout.scale_lsb, 2)]
    # A slope is brought to the top of 64 bits and back, which copies its sign.
    top = 64 - layout.slope_bits
    a = (high << top - layout.slope_x_lsb >> top) << shift
    b = (high << top - layout.slope_y_lsb >> top) << shift
    start = _bits(high, layout.z_lsb, layout.z_bits) << FRACTIONS
    look = _bits(low, layout.diffuse_lsb, layout.look_bits)
    pixels, stride = canvas.reshape(-1), canvas.shape[1]
    symmetric = low & 1 == 0
    raised = high >> layout.raised_lsb & 1
    first_way = 1 - 2 * (high >> layout.outwards_lsb & 1)
    last_way = 2 * (high >> layout.outwards_lsb + 1 & 1) - 1
    rows = filled_rows(np.uint64(low))
    while rows:
        carry = lowest_bit(rows)
        rows &= rows - ONE
        row: Any = np.int64(carry // ROW_BITS)
        first, last = low >> 1 + 6 * row & 7, low >> 4 + 6 * row & 7
        begin = (y - ABOVE + row) % BLOCK * stride + x + first
        total = start + b * row + a * first
        _draw_row(pixels, begin, last - first + 1, total, a, look, layout.background)
        if symmetric and not (raised and row == ROWS - 1):
            below = BLOCK - 1 - raised - row
            sides = low >> layout.side_lsb + 2 * row
            rotated = BLOCK - 1 - last + first_way * (sides & 1)
            last = BLOCK - 1 - first + last_way * (sides >> 1 & 1)
            first, last = _inside(rotated), _inside(last)
            begin = (y - ABOVE + below) % BLOCK * stride + x + first
            total = start + b * below + a * first
            _draw_row(pixels, begin, last - first + 1, total, a, look, layout.background)


@cached_njit(inline="always")
def _draw_row(
    pixels: Any, begin: int, count: int, total: int, a: int, look: int, background: int
) -> None:
    """Draw ``count`` pixels of a line, the first of them at the sum ``total``.

    Int64 holds the sums of every configuration. A slope has at most 8 bits and is shifted by at
    most 4, so it lies in -2048 .. 2032; columns and lines go to 7; 2 Z is at most 2^18 - 2. So a
    sum lies in -28672 .. 290590, a depth behind DEPTH_LSB is less than 2^48, and a lane past the
    row, which does not count, adds at most 8 slopes.
    """
    for offset in range(0, count, LANES):
        # Pixels past the row are written back unchanged, which avoids branches.
        for lane in range(LANES):
            old = pixels[begin + offset + lane]
            z = total + a * (offset + lane) >> SUM_FRACTION
            z = min(max(z, 0), background) << DEPTH_LSB
            passes = (z | LOOK_MASK < old) & (offset + lane < count)
            pixels[begin + offset + lane] = z | look if passes else old


@cached_njit()
def _close_line(
    canvas: Any,
    line: int,
    ambient: Any,
    coefficients: Any,
    layout: PlaneLayout,
    depth: Any,
    colour: Any,
) -> None:
    """Store depth and colour of a line's pixels; see ``kernel._close_line`` for the sums' range."""
    bits = layout.intensity_bits
    for column in range(depth.shape[1]):
        pixel = canvas[line % BLOCK, column]
        look = pixel & LOOK_MASK
        if look == LOOK_MASK:
            continue
        depth[line, column] = pixel >> DEPTH_LSB
        d, s, material = _bits(look, 0, bits), _bits(look, bits, bits), look >> 2 * bits
        for channel in range(3):
            kd, ks = coefficients[material, 0, channel], coefficients[material, 1, channel]
            total = (ambient[channel] + kd * d + ks * s) >> layout.colour_shift
            colour[line, column, channel] = min(total, layout.channel_max)
