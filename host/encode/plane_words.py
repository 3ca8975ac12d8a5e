"""Writes plane words: a depth at the block's corner, and two slopes."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION

__all__ = ["Layout", "layout_of", "plane_bits", "put_plane"]

SHIFT = np.array(SHIFTS, np.int64)


class Layout(NamedTuple):
    """The positions of a plane word's fields, the high half's from its own bit 0.

    Parameters
    ----------
    look_lsb, x_lsb, side_lsb, raised_lsb, outwards_lsb, slope_x_lsb, slope_y_lsb, scale_lsb, z_lsb
        Lowest bits.
    slope_most, z_most
        Largest slope before the shift, and largest Z.
    largest
        Largest depth that draws.
    """

    look_lsb: int
    x_lsb: int
    side_lsb: int
    raised_lsb: int
    outwards_lsb: int
    slope_x_lsb: int
    slope_y_lsb: int
    scale_lsb: int
    z_lsb: int
    slope_most: int
    z_most: int
    largest: int


def layout_of(config: EngineConfig) -> Layout:
    """Return the layout of a configuration with planes."""
    return Layout(
        look_lsb=config.diffuse.lsb,
        x_lsb=config.x.lsb,
        side_lsb=config.side(0, 0).lsb,
        raised_lsb=config.raised.lsb - LOW_BITS,
        outwards_lsb=config.outwards(0).lsb - LOW_BITS,
        slope_x_lsb=config.slope_x.lsb - LOW_BITS,
        slope_y_lsb=config.slope_y.lsb - LOW_BITS,
        scale_lsb=config.scale.lsb - LOW_BITS,
        z_lsb=config.z.lsb - LOW_BITS,
        slope_most=(1 << config.slope_bits - 1) - 1,
        z_most=config.z.mask,
        largest=config.background_depth - 1,
    )


@nb.njit(error_model="numpy")
def plane_bits(
    depth: float, change_x: float, change_y: float, right: float, down: float, layout: Any
) -> int:
    """Return the high half of a word: Z, both slopes and the scale.

    The plane is exact at its point but for the rounding of Z; the slopes are rounded to nearest, at
    the finest scale that holds both, and cut off at the coarsest.

    Parameters
    ----------
    depth
        Of a point of the plane, in levels.
    change_x, change_y
        Change of depth from column to column and from line to line, in levels.
    right, down
        From the centre of the block's first pixel to the point, in pixels.
    layout
        Positions of the fields.
    """
    unit, most = float(1 << SUM_FRACTION), float(layout.slope_most)
    steepest = unit * max(abs(change_x), abs(change_y))
    scale = 0
    while scale < len(SHIFT) - 1 and not steepest < (most + 0.5) * (1 << SHIFT[scale]):
        scale += 1
    step = float(1 << SHIFT[scale])
    # NaN, from a frame without a depth range, counts as flat and nearest.
    a = min(max(math.floor(_finite(change_x) * unit / step + 0.5), -most), most)
    b = min(max(math.floor(_finite(change_y) * unit / step + 0.5), -most), most)
    corner = _finite(depth) - (a * right + b * down) * step / unit
    # Half a level more, as the engine cuts off; and half a unit, to round here.
    z = math.floor((corner + 0.5) * (1 << Z_FRACTION) + 0.5)
    z = min(max(z, 0.0), float(layout.z_most))
    mask = 2 * layout.slope_most + 1
    return (
        (int(a) & mask) << layout.slope_x_lsb
        | (int(b) & mask) << layout.slope_y_lsb
        | scale << layout.scale_lsb
        | int(z) << layout.z_lsb
    )


@nb.njit(inline="always")
def _finite(value: float) -> float:
    """Return a value, an infinite one cut off far beyond every depth; 0 for NaN."""
    return min(max(value, -1e9), 1e9) if value == value else 0.0


@nb.njit(inline="always")
def put_plane(low: int, high: int, x: int, line: int, at: int, to: Any, layout: Any) -> int:
    """Write a word whose block has rows 4 and up from ``line`` on; return the next slot.

    ``to`` has the slots: words, shape (slots, 2), int64, and lines.
    """
    words, lines = to[0], to[1]
    words[at, 0] = low | x << layout.x_lsb
    words[at, 1] = high
    lines[at] = line
    return at + 1
