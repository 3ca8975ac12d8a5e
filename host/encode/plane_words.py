"""Writes plane words: a depth at the block's corner, and two slopes."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION

from .tile import may_touch

__all__ = ["Layout", "layout_of", "plane_bits", "put_plane"]

SHIFT = np.array(SHIFTS, np.int64)

BEYOND = 1e300
"""Infinity, for sums and products that must stay finite."""


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

    The plane is exact at its point but for the rounding of Z. Where Z at the block's first pixel
    would be beyond its range, the plane is flattened so that it still goes through the point.

    Parameters
    ----------
    depth
        Of a point of the plane, in levels. Any float: NaN counts as nearest.
    change_x, change_y
        Change of depth from column to column and from line to line, in levels. Any floats: NaN
        counts as flat.
    right, down
        From the centre of the block's first pixel to the point, in pixels.
    layout
        Positions of the fields.
    """
    # All that follows is finite. A slope is at most 127 and a step 4, so that both add less than
    # 2^15 to a corner; a depth of 1e300 stays what it is. What is cut off to Z's range before it
    # becomes an integer has at most 17 bits.
    depth = _finite(depth)
    a, b, scale, step = _slopes(_finite(change_x), _finite(change_y), layout)
    corner = depth - (a * right + b * down) * step
    # Z is half a level more, as the engine cuts off.
    furthest = layout.z_most / float(1 << Z_FRACTION) - 0.5
    held = min(max(corner, -0.5), furthest)
    if corner != held:
        # Below 0: the point is beyond the range too, and the corner further beyond.
        share = min(max((depth - held) / (depth - corner), 0.0), 1.0)
        a, b, scale, step = _slopes(share * a * step, share * b * step, layout)
        held = min(max(depth - (a * right + b * down) * step, -0.5), furthest)
    z = math.floor((held + 0.5) * (1 << Z_FRACTION) + 0.5)
    mask = 2 * layout.slope_most + 1
    return (
        (int(a) & mask) << layout.slope_x_lsb
        | (int(b) & mask) << layout.slope_y_lsb
        | scale << layout.scale_lsb
        | int(z) << layout.z_lsb
    )


@nb.njit(error_model="numpy")
def _slopes(change_x: float, change_y: float, layout: Any) -> tuple[float, float, int, float]:
    """Return two slopes rounded to nearest, at the finest scale that holds both; scale and step.

    Beyond the coarsest scale both are cut off by the same factor, so that the plane leans the same
    way: a disc seen edge on covers pixels along a line on which its depth hardly changes.

    Parameters
    ----------
    change_x, change_y
        Finite, in levels a pixel.

    Returns
    -------
    a, b
        Whole numbers, in -slope_most .. slope_most.
    scale
        Index into ``SHIFTS``.
    step
        Levels that 1 of a slope stands for.
    """
    most = float(layout.slope_most)
    steepest = max(abs(change_x), abs(change_y))
    scale, step = 0, 1.0 / (1 << SUM_FRACTION)
    while scale < len(SHIFT) - 1 and not steepest < (most + 0.5) * step:
        scale += 1
        step = float(1 << SHIFT[scale]) / (1 << SUM_FRACTION)
    if steepest > most * step:
        change_x, change_y = change_x / steepest * most * step, change_y / steepest * most * step
    a, b = math.floor(change_x / step + 0.5), math.floor(change_y / step + 0.5)
    return a, b, scale, step


@nb.njit(inline="always")
def _finite(value: float) -> float:
    """Return a value, an infinite one cut off far beyond every depth; 0 for NaN."""
    return min(max(value, -BEYOND), BEYOND) if value == value else 0.0


@nb.njit
def put_plane(low: int, high: int, x: int, line: int, at: int, to: Any, layout: Any) -> int:
    """Write a word whose block has rows 4 and up from ``line`` on, if it may touch the tile.

    Return the next slot; see :class:`splatline.host.encode.tile.Target` for ``to``.
    """
    words, lines, _, _, origin_x, origin_y, right, bottom, _, _, _ = to
    words[at, 0] = low | x - origin_x << layout.x_lsb
    words[at, 1] = high
    lines[at] = line - origin_y
    return at + may_touch(x, line, origin_x, origin_y, right, bottom)
