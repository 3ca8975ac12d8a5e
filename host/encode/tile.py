"""A tile: the part of an image that a frame draws, and the words that a frame of it has.

All floating-point work is in the coordinates of the whole image, clipped to the whole image. A tile
only decides which words are written, and takes its origin from their columns and lines. So the
words of a tile are words of the whole image, bit for bit but for X.

An engine clips words at the right and lower border. X is unsigned, so that no word begins left of
the image. A tile's frame therefore has a guard band on the left and above, which the engine draws
and the host throws away. The first tile of a row or column needs none.

What is done to a pixel because of its neighbours (``close_specks``) must be the same in each tile.
So each tile is drawn whole to ``HEM`` pixels beyond its own, on each side where another tile is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb

from splatline.contract.config import BLOCK, ROWS

from .areas import REACH

__all__ = [
    "GUARD_COLUMNS",
    "GUARD_LINES",
    "HEM",
    "Target",
    "Tile",
    "first_column_of",
    "first_line_of",
    "first_part",
    "may_touch",
    "whole_image",
]

HEM = 2 + REACH
"""Pixels beside a tile's own that its frame draws as the whole image has them: those that decide
about a small area (``areas.REACH``), and one for each round of specks before."""

GUARD_COLUMNS, GUARD_LINES = 4 * BLOCK, 3 * BLOCK
"""Columns and lines that the frames of two neighbouring tiles share. A word reaches at most seven
columns and three lines into a tile, and each of two hems has ``HEM``. The frame begins at a
multiple of ``sort_by_line.PERIOD`` columns, so that many are shared."""


class Tile(NamedTuple):
    """A tile of an image, in pixels of the whole image.

    Parameters
    ----------
    origin_x, origin_y
        Column and line at which its frame begins: 0, or those of its first pixel less the guard
        band. ``origin_x`` is a multiple of ``sort_by_line.PERIOD``, so that words come in the order
        of the whole image.
    right, bottom
        The column and the line behind its frame's last.
    hem_right, hem_below
        Columns and lines at the end of its frame that the next tile has as its own.
    """

    origin_x: int
    origin_y: int
    right: int
    bottom: int
    hem_right: int = 0
    hem_below: int = 0

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of its frame, with all that is thrown away."""
        return self.right - self.origin_x, self.bottom - self.origin_y

    @property
    def guard(self) -> tuple[int, int]:
        """Columns and lines at the beginning of its frame that are thrown away."""
        columns, lines = GUARD_COLUMNS - HEM, GUARD_LINES - HEM
        return columns * (self.origin_x > 0), lines * (self.origin_y > 0)

    @property
    def own(self) -> tuple[slice, slice]:
        """Lines and columns of its frame that are its own."""
        (columns, lines), (width, height) = self.guard, self.size
        return slice(lines, height - self.hem_below), slice(columns, width - self.hem_right)

    @property
    def place(self) -> tuple[slice, slice]:
        """Lines and columns of the whole image that are its own."""
        lines, columns = self.own
        return (
            slice(self.origin_y + lines.start, self.origin_y + lines.stop),
            slice(self.origin_x + columns.start, self.origin_x + columns.stop),
        )


def whole_image(width: int, height: int) -> Tile:
    """Return the tile that is a whole image."""
    return Tile(0, 0, width, height)


class Target(NamedTuple):
    """Destination of the words, for compiled code: a flat tuple, as numba's parallel loops require.

    It is copied at each call, so that it is as small as can be.

    Parameters
    ----------
    words, lines
        Slots: shape (slots,), uint64, or plane words of shape (slots, 2), int64; and (slots,),
        int16.
    width, height
        Of the whole image.
    origin_x, origin_y, right, bottom
        See :class:`Tile`.
    x_lsb, z_lsb
        Lowest bits of X and Z in a word of 64 bits.
    largest
        Largest depth that draws.
    """

    words: Any
    lines: Any
    width: int
    height: int
    origin_x: int
    origin_y: int
    right: int
    bottom: int
    x_lsb: int
    z_lsb: int
    largest: int


@nb.njit(inline="always")
def first_column_of(to: Any) -> int:
    """Return the first column that a tile's frame draws whole."""
    return to.origin_x + (GUARD_COLUMNS - 2 * HEM) * (to.origin_x > 0)


@nb.njit(inline="always")
def first_line_of(to: Any) -> int:
    """Return the first line that a tile's frame draws whole."""
    return to.origin_y + (GUARD_LINES - 2 * HEM) * (to.origin_y > 0)


@nb.njit(inline="always")
def may_touch(x: int, line: int, origin_x: int, origin_y: int, right: int, bottom: int) -> bool:
    """Return whether a word may touch what a tile's frame draws whole.

    Its block has the lines from ``line`` - 4 on, and eight columns. The ninth that the contract
    knows is in no word of the host, whose shapes half a column to the right have seven
    (``half_pixel``).
    """
    left = origin_x + (GUARD_COLUMNS - 2 * HEM - BLOCK + 1) * (origin_x > 0)
    above = origin_y + (GUARD_LINES - 2 * HEM - ROWS + 1) * (origin_y > 0)
    return left <= x < right and above <= line < bottom + ROWS


@nb.njit(inline="always")
def first_part(first: int, length: int, least: int) -> int:
    """Return where the first of some parts begins that reaches a column or line, or lies beyond.

    Parameters
    ----------
    first, length
        Where the first part of all begins, and the parts' length.
    least
        The column or line.
    """
    return first if first + length > least else first + (least - first) // length * length
