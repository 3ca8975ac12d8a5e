"""The clock of a window of lanes: which tiles an element still has, and which words leave.

Neither colours nor depths matter: a lane takes as long for a pixel that does not pass.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from ..rtl.format import ROWS
from .pipeline_model import (
    ABOVE,
    COLUMN,
    EMPTY,
    END_WORD,
    FIRST,
    FOLLOWING,
    HEAD,
    LAST,
    LINES,
    WORD,
    Machine,
    advance,
    new_front,
)

__all__ = ["least_lane_cycles", "walk_lanes"]

SIDE = 4
"""Lines and columns of a tile."""

TILES = 4
"""Tiles of a block: upper left, upper right, lower left, lower right."""

STRETCH = 32
"""Words whose marks are taken together."""

PAIR = 2
"""Words of a mark."""


class Lanes(NamedTuple):
    """The window's registers, as arrays.

    Parameters
    ----------
    tiles
        Columns that the element at hand covers of each line of its block, a bit each from its X on:
        shape (4, 4), by tile and line of the tile. Unclipped.
    left
        Tiles that it still has, a bit each: shape (1,).
    drawn
        The tile drawn in the cycle before: its first line and column, and the columns covered of
        each line, clipped; 0 if there is none: shape (6,).
    marks
        Pairs of words that were written, by place of their line: shape (16, pairs).
    walk
        See ``OLDEST`` and what follows: shape (7,).
    """

    tiles: Any
    left: Any
    drawn: Any
    marks: Any
    walk: Any


OLDEST, TOP, WRITTEN, PAIRS, SECOND, NEXT, FLUSHED = range(7)
"""Registers of the walker: the first line in the window; the line above which all lines are
complete; a bit a place that was written into; marked pairs of the stretch at hand that are left;
whether the second word of one is next; the next stretch; whether a word left one cycle before."""


@nb.njit(cache=True)
def walk_lanes(words: Any, machine: Machine) -> int:
    """Return the cycles from the first code word taken to the end beat, both included.

    Parameters
    ----------
    words
        Code words: shape (n,), int64 (the bits of unsigned ones).
    machine
        The engine and the image.

    Returns
    -------
    int
        0 if there is no end word.
    """
    pairs = machine.half_words
    lanes = Lanes(
        np.zeros((TILES, SIDE), np.int64),
        np.zeros(1, np.int64),
        np.zeros(2 + SIDE, np.int64),
        np.zeros((LINES, pairs), np.bool_),
        np.zeros(7, np.int64),
    )
    walk = lanes.walk
    walk[TOP] = -ABOVE
    tile = np.zeros(2 + SIDE, np.int64)
    x = 0
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        # The last pixels to be cleared are written one cycle after.
        clearing, settling = cycle < machine.clearing, cycle <= machine.clearing
        head, top = front.held[HEAD], front.tops[HEAD]
        ends = head != EMPTY and head == front.state[END_WORD]
        if ends and walk[WRITTEN] == 0 and not walk[FLUSHED]:
            return cycle + 2  # the end beat is on the port in the next cycle

        left = lanes.left[0]
        element = head != EMPTY and not ends and left != 0
        place = 1 << walk[OLDEST] % LINES
        leaving = walk[OLDEST] < walk[TOP]
        taking = leaving and walk[WRITTEN] & place != 0 and walk[PAIRS] == 0 and not clearing
        rows = 0  # of lanes that the tile draws into
        going = False
        if element:
            number = 0
            while not left >> number & 1:
                number += 1
            _clip(lanes.tiles[number], top, x, number, tile, machine)
            near = tile[0] - walk[OLDEST] < LINES - SIDE
            meets = machine.hazard and _conflicts(tile, lanes.drawn)
            going = near and not settling and not taking and not meets
        if going:
            left &= left - 1
            lanes.drawn[:] = tile
            for k in range(SIDE):
                if tile[2 + k]:
                    rows |= 1 << (tile[0] + k) % SIDE
        else:
            lanes.drawn[2:] = 0
        flushing = walk[PAIRS] > 0 and not clearing and not rows >> walk[OLDEST] % SIDE & 1
        _step(lanes, leaving, taking, flushing)
        if going:
            _mark(tile, lanes)
        if ends or element:
            walk[TOP] = top
        done = head != EMPTY and not ends and left == 0
        lanes.left[0] = left
        if advance(words, front, done, machine):
            head = front.held[HEAD]
            lanes.left[0] = 0
            if head != EMPTY and head != front.state[END_WORD]:
                x = words[head] >> machine.x_lsb & machine.x_mask
                lanes.left[0] = _cut(words[head], lanes.tiles)
        cycle += 1
    return 0


@nb.njit(cache=True)
def least_lane_cycles(words: Any) -> int:
    """Return the least cycles in which lanes can draw elements, one pixel a lane and cycle.

    Of an element those are as many as its busiest lane has pixels. Its lanes are told apart by the
    places of their pixels in tiles. Clipping is left out.

    Parameters
    ----------
    words
        Code words of elements: shape (n,), int64.
    """
    tiles = np.zeros((TILES, SIDE), np.int64)
    total = 0
    for i in range(len(words)):
        _cut(words[i], tiles)
        busiest = 1
        for k in range(SIDE):
            for j in range(SIDE):
                pixels = 0
                for number in range(TILES):
                    pixels += tiles[number, k] >> j & 1
                busiest = max(busiest, pixels)
        total += busiest
    return total


@nb.njit(cache=True)
def _cut(word: int, tiles: Any) -> int:
    """Cut an element into its tiles; return which of them have a pixel, clipped away or not."""
    tiles[:] = 0
    for row in range(ROWS):
        first, last = word >> FIRST[row] & COLUMN, word >> LAST[row] & COLUMN
        if first > last:
            continue
        columns = (2 << last) - (1 << first)
        tiles[0, row], tiles[1, row] = columns & 15, columns >> SIDE
        if word & 1 == 0:  # the row turned by 180 degrees
            turned = (2 << (7 - first)) - (1 << (7 - last))
            tiles[2, 3 - row], tiles[3, 3 - row] = turned & 15, turned >> SIDE
    left = 0
    for number in range(TILES):
        left |= int(tiles[number].any()) << number
    return left


@nb.njit(cache=True)
def _clip(columns: Any, top: int, x: int, number: int, tile: Any, machine: Machine) -> None:
    """Set ``tile`` to a tile's place and what lies in the image: of columns, in its words."""
    line, column = top + SIDE * (number >> 1), x + SIDE * (number & 1)
    tile[0], tile[1] = line, column
    # A tile that begins right of the image has no column.
    room = max((machine.last_column // WORD + 1) * WORD - column, 0)
    inside = (1 << min(room, SIDE)) - 1
    for k in range(SIDE):
        tile[2 + k] = columns[k] & inside if 0 <= line + k <= machine.last_line else 0


@nb.njit(cache=True)
def _conflicts(tile: Any, drawn: Any) -> bool:
    """Return whether two tiles have a pixel in common."""
    across = drawn[1] - tile[1]
    if abs(across) >= SIDE:
        return False
    for k in range(SIDE):
        other = tile[0] + k - drawn[0]
        if 0 <= other < SIDE:
            theirs = drawn[2 + other]
            if tile[2 + k] & (theirs << across if across >= 0 else theirs >> -across):
                return True
    return False


@nb.njit(cache=True)
def _mark(tile: Any, lanes: Lanes) -> None:
    """Mark the words that a tile is drawn into."""
    for k in range(SIDE):
        line, columns = tile[0] + k, tile[2 + k]
        for j in range(SIDE):
            if columns >> j & 1:
                lanes.marks[line % LINES, (tile[1] + j) // (WORD * PAIR)] = True
                lanes.walk[WRITTEN] |= 1 << line % LINES


@nb.njit(cache=True)
def _step(lanes: Lanes, leaving: bool, taking: bool, flushing: bool) -> None:
    """Move the walker on: by a word, a stretch, an empty line, or over all if none is written."""
    walk, marks = lanes.walk, lanes.marks
    oldest = walk[OLDEST]
    place = oldest % LINES
    stretch = min(STRETCH // PAIR, marks.shape[1])
    stretches = marks.shape[1] // stretch
    left = False
    if flushing:
        if walk[SECOND]:
            walk[PAIRS] -= 1
            left = walk[PAIRS] == 0 and walk[NEXT] == stretches
        walk[SECOND] ^= 1
    walk[FLUSHED] = flushing
    if taking:
        begin = walk[NEXT] * stretch
        found = marks[place, begin : begin + stretch]
        walk[PAIRS] = found.sum()
        found[:] = False
        walk[NEXT] += 1
        left = walk[PAIRS] == 0 and walk[NEXT] == stretches
    if left:
        walk[NEXT] = 0
    if leaving and walk[WRITTEN] == 0:
        walk[OLDEST] = walk[TOP]
    elif left or (leaving and not walk[WRITTEN] >> place & 1):
        walk[OLDEST] = oldest + 1
    if left:
        walk[WRITTEN] &= ~(1 << place)
