"""Compact words: an element's size and levels, for an engine with a shape ROM."""

from __future__ import annotations

import math
from typing import Any

import numba as nb

from splatline.contract.config import BLOCK, COMPACT, ROWS
from splatline.contract.presets import PAPER
from splatline.host.visibility.view import LARGEST

from .paper_shapes import encode_symmetric
from .shape_table import SIZES
from .write_words import corner, put_symmetric

__all__ = ["encode_compact"]

# SCANS has the same place in every configuration, and so have the fields in it.
SCANS_LSB = PAPER.scans.lsb
MARK = COMPACT << PAPER.compact_mark.lsb - SCANS_LSB
SIZE = PAPER.compact_size.lsb - SCANS_LSB
LEVEL_X = PAPER.compact_level_x.lsb - SCANS_LSB
LEVEL_Y = PAPER.compact_level_y.lsb - SCANS_LSB
PART = PAPER.compact_part.lsb - SCANS_LSB

PARTS = 4
"""Groups of four lines of a shape of more than eight."""

ROUNDING = 1e-6
"""Pixels by which a shape may be higher than computed."""


@nb.njit
def encode_compact(
    column: float,
    line: float,
    diameter: float,
    shape: tuple[int, int],
    largest: int,
    table: Any,
    slopes: Any,
    common: int,
    at: int,
    to: Any,
) -> int:
    """Write a splat's words as ``encode_symmetric`` does, but without scans.

    Diameters of 2 up to ``largest`` become compact words: one up to 8, and above one for every four
    lines that may have a pixel. Other diameters become plain words. So do splats that begin left of
    the image or above it, where no symmetric word can begin.

    Parameters
    ----------
    largest
        Largest size that the engine's ROM holds.
    column, line, diameter, shape, table, slopes, common, at, to
        See ``encode_symmetric``; the table is for the plain words.
    """
    width, height = to.width, to.height
    size = math.ceil(min(diameter, 2.0 * LARGEST))
    x, y = corner(column), corner(line)
    level_x, level_y = shape
    small = size <= BLOCK
    x -= BLOCK // 2 if small else BLOCK
    if size <= 1 or size > min(largest, SIZES - 1) or x < 0 or (small and y < 0):
        return encode_symmetric(column, line, diameter, shape, table, slopes, common, at, to)
    if x >= width:
        return at
    scans = MARK | size << SIZE | level_x << LEVEL_X | level_y << LEVEL_Y
    if small:
        return put_symmetric(common, scans, x, y, at, to) if y - ROWS < height else at
    # The outer parts begin four lines from the middle.
    outer = _reach(size, slopes[level_x], slopes[level_y]) + ROUNDING < ROWS + 0.5
    for part in range(1 if outer else 0, PARTS - 1 if outer else PARTS):
        top = y + ROWS * (part - PARTS // 2)
        if -ROWS < top < height:
            at = put_symmetric(common, scans | part << PART, x, top + ROWS, at, to)
    return at


@nb.njit(inline="always")
def _reach(size: int, slope_x: float, slope_y: float) -> float:
    """Return how far an ellipse reaches above its centre: beyond, ``row_span`` has no root."""
    across = 1.0 + slope_x * slope_x
    return 0.5 * size * math.sqrt(across / (across + slope_y * slope_y))
