"""The compiled loops of the golden renderer for plane words: a depth for every pixel.

It is written from ``docs/contract.md``, "Plane words", and shares with the hardware only the
positions of the fields. Lines, bands and the moving canvas are as in :mod:`.kernel`; a pixel of the
canvas holds its depth, and the look of the code word that drew it. The eight columns of a row are
tested together, in one vector register of the processor.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION

from .kernel import ABOVE, BELOW

__all__ = ["PlaneLayout", "draw_plane_bands", "plane_layout_of"]

EMPTY_LOOK = -1
"""Look of a pixel that nothing was drawn into; those of code words are at least 0."""

FRACTIONS = SUM_FRACTION - Z_FRACTION
"""Bits by which Z is shifted left to have the fraction bits of the sum."""

SHIFT = np.array(SHIFTS, np.int64)


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
    largest: int
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
        largest=config.background_depth - 1,
        colour_shift=config.colour_shift,
        channel_max=config.channel_max,
    )


@nb.njit(parallel=True, cache=True)
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
        # A block may reach beyond the right border.
        depths = np.zeros((BLOCK, width + BLOCK), np.int32)
        looks = np.zeros((BLOCK, width + BLOCK), np.int32)
        rows = np.empty((BLOCK, 2), np.int32)
        for y in range(begin - BELOW, end + ABOVE):
            if y + BELOW < end:
                line = y + BELOW
                for column in range(width):
                    depths[line % BLOCK, column] = depth[line, column]
                    looks[line % BLOCK, column] = EMPTY_LOOK
            if y >= 0:
                for index in range(starts[y], starts[y + 1]):
                    low, high = words[index, 0], words[index, 1]
                    _draw_word(low, high, y, layout, rows, depths, looks)
            if y - ABOVE >= begin:
                _close_line(depths, looks, y - ABOVE, ambient, coefficients, layout, depth, colour)


@nb.njit(cache=True, inline="always")
def _bits(word: int, lsb: int, width: int) -> int:
    """Return the value of an unsigned field."""
    return word >> lsb & (1 << width) - 1


@nb.njit(cache=True)
def _draw_word(
    low: int, high: int, y: int, layout: PlaneLayout, rows: Any, depths: Any, looks: Any
) -> None:
    """Draw a code word into the canvas; a control word has no row and draws nothing."""
    x = _bits(low, layout.x_lsb, layout.x_bits)
    if x >= depths.shape[1] - BLOCK:
        return
    below = _find_rows(low, high, layout, rows)
    shift = SHIFT[_bits(high, layout.scale_lsb, 2)]
    # A slope is brought to the top of 64 bits and back, which copies its sign.
    top = 64 - layout.slope_bits
    a = (high << top - layout.slope_x_lsb >> top) << shift
    b = (high << top - layout.slope_y_lsb >> top) << shift
    start = _bits(high, layout.z_lsb, layout.z_bits) << FRACTIONS
    look = np.int32(_bits(low, layout.diffuse_lsb, layout.look_bits))
    largest = np.int32(layout.largest)
    step = np.int32(a)
    for row in range(below):
        first, last = rows[row, 0], rows[row, 1]
        if first > last:
            continue
        line = (y - ABOVE + row) % BLOCK
        # 16 bits hold the sums of the preset. Of any configuration, a slope has less than
        # 2^(8 - 1 + 4) and 2 Z has 18 bits: the sum is below 2^18 + 14 * 2^11 < 2^31.
        total = np.int32(start + b * row)
        for column in range(BLOCK):
            z = total + step * np.int32(column) >> np.int32(SUM_FRACTION)
            z = min(max(z, np.int32(0)), largest)
            old = depths[line, x + column]
            passes = (column >= first) & (column <= last) & (z < old)
            depths[line, x + column] = z if passes else old
            looks[line, x + column] = look if passes else looks[line, x + column]


@nb.njit(cache=True)
def _find_rows(low: int, high: int, layout: PlaneLayout, rows: Any) -> int:
    """Set first and last column of the block's rows; return how many rows there are."""
    for row in range(ROWS):
        rows[row, 0], rows[row, 1] = _bits(low, 1 + 6 * row, 3), _bits(low, 4 + 6 * row, 3)
    if low & 1:
        return ROWS
    raised = high >> layout.raised_lsb & 1
    first_out = high >> layout.outwards_lsb & 1
    last_out = high >> layout.outwards_lsb + 1 & 1
    sides = low >> layout.side_lsb
    rows[BLOCK - 1, 0], rows[BLOCK - 1, 1] = 1, 0
    for row in range(ROWS - raised):
        first = BLOCK - 1 - rows[row, 1] + (sides >> 2 * row & 1) * (1 - 2 * first_out)
        last = BLOCK - 1 - rows[row, 0] - (sides >> 2 * row + 1 & 1) * (1 - 2 * last_out)
        empty = rows[row, 0] > rows[row, 1]
        below = BLOCK - 1 - raised - row
        rows[below, 0] = 1 if empty else min(max(first, 0), BLOCK - 1)
        rows[below, 1] = 0 if empty else min(max(last, 0), BLOCK - 1)
    return BLOCK


@nb.njit(cache=True)
def _close_line(
    depths: Any,
    looks: Any,
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
        look = looks[line % BLOCK, column]
        if look == EMPTY_LOOK:
            continue
        depth[line, column] = depths[line % BLOCK, column]
        d, s, material = _bits(look, 0, bits), _bits(look, bits, bits), look >> 2 * bits
        for channel in range(3):
            kd, ks = coefficients[material, 0, channel], coefficients[material, 1, channel]
            total = (ambient[channel] + kd * d + ks * s) >> layout.colour_shift
            colour[line, column, channel] = min(total, layout.channel_max)
