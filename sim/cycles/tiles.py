"""The clock of a window of lanes: which tiles an element still has, and which words leave.

Neither colours nor depths matter: a lane takes as long for a pixel that does not pass.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.codeword import unfold
from splatline.contract.config import BLOCK

from .front import ABOVE, EMPTY, END_WORD, FIRST_STAGE, FOLLOWING, HEAD, Machine, advance, new_front

__all__ = ["least_lane_cycles", "walk_lanes"]

SIDE = 4
"""Lines of a tile; a word's pixels are its columns."""

STRETCH = 32
"""Words whose marks are taken together."""

PAIR = 2
"""Words of a mark."""

NOTHING, TILE, END = range(3)
"""What the window is given: nothing, a tile or the end of the frame."""


class Lanes(NamedTuple):
    """The window's registers, as arrays.

    Parameters
    ----------
    tiles
        Columns that the element at hand covers of each line of its block, a bit each from its X on:
        shape (tiles, 4), by tile (the upper ones from the left, the lower ones) and line of the
        tile. Unclipped.
    left
        Tiles that it still has, a bit each: shape (1,).
    marks
        Pairs of words that were written, by place of their line: shape (lines, pairs).
    walk
        See ``OLDEST`` and what follows: shape (13,).
    """

    tiles: Any
    left: Any
    dirty_bits: Any
    walk: Any


(
    OLDEST,
    TOP,
    WRITTEN,
    PAIRS,
    SECOND,
    AHEAD,
    FLUSHED,
    TAKING,
    ASKING,
    NOW,
    BEFORE,
    TURN,
    CHOSEN,
) = range(13)
"""Registers of the flush scan: the first line in the window; the line above which all lines are
complete; a bit a place that was written into; marked pairs of the stretch at hand that are left;
whether the second word of the one that is asked for is next; stretches that the line still has, a
bit each; whether a word left one cycle before; whether a stretch's marks are taken, and whether a
pair is asked for; stretches that tiles reached since the window moved on by its own height, and
those before, a bit each; which of these heights it is in, modulo 2; and the stretch whose marks are
taken next."""


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
    across = BLOCK // machine.pixels
    lanes = _new_lanes(machine)
    walk = lanes.walk
    tile, coming = np.zeros(3 + SIDE, np.int64), np.zeros(3 + SIDE, np.int64)
    given, meets, drawn, ending, halfway = NOTHING, False, False, False, False
    lagging = False  # in the cycle before, for lines that leave to go before tiles
    near = np.zeros(2, np.bool_)  # lines of upper and of lower tiles are in the window
    x, right = 0, 0
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        # The last pixels to be cleared are written one cycle after.
        clearing, settling = cycle < machine.clearing, cycle <= machine.clearing
        if ending and not (walk[FLUSHED] or halfway):
            return cycle + 2  # the end beat is on the port in the next cycle
        ending = given == END and walk[WRITTEN] == 0

        taking = walk[TAKING]
        oldest = walk[OLDEST]
        # A pair left one cycle before: no other does, and its odd word is still to come.
        halfway = machine.flush_words == PAIR and walk[FLUSHED]
        conflict = machine.hazard and meets and drawn
        meeting = given == TILE and _meets_row(tile, walk[OLDEST])
        # Marks are taken beside a tile where only their own row of lanes must be free for it.
        waits = taking and (meeting or machine.flush_words == 1)
        going = given == TILE and not (settling or waits or conflict)
        first, lagging = lagging and not halfway, (walk[TOP] - walk[OLDEST]) % SIDE >= SIDE // 2
        flushing = walk[ASKING] and not (clearing or halfway) and (first or not meeting)
        going = going and not (walk[ASKING] and first and meeting)
        reach = _reach(tile, machine) if given == TILE else 0
        _step(lanes, flushing, reach, not clearing, machine)
        if going:
            _mark(tile, lanes, machine)
        drawn = going

        # The next tile, and the next element.
        done = False
        if given == NOTHING or going:
            head, top = front.held[HEAD], front.tops[HEAD]
            ends = head != EMPTY and head == front.state[END_WORD]
            left = lanes.left[0]
            number = _lowest(left)
            may = ends or near[0 if left & ((1 << across) - 1) else 1]
            given = END if ends else TILE if left and may else NOTHING
            if head != EMPTY:
                walk[TOP] = top
            if given == TILE:
                _clip(lanes.tiles[number], top, x, right, number, coming, machine)
                lanes.left[0] = left & (left - 1)
            meets = going and given == TILE and _meet(coming, tile, machine)
            tile[:] = coming
            done = head != EMPTY and may and lanes.left[0] == 0
        waiting = front.held[HEAD] != EMPTY and not (near[0] and near[1])
        top = front.tops[HEAD if waiting else FIRST_STAGE]
        moved = advance(words, front, done, machine)
        if waiting or moved:
            _compare(near, top - oldest, waiting and moved, machine)
        if moved:
            head = front.held[HEAD]
            lanes.left[0] = 0
            if head != EMPTY and head != front.state[END_WORD]:
                x = words[head] >> machine.x_lsb & machine.x_mask
                lanes.left[0], right = _cut(words[head], lanes.tiles, machine.pixels)
        cycle += 1
    return 0


@nb.njit(cache=True)
def _new_lanes(machine: Machine) -> Lanes:
    """Return the registers after reset."""
    walk = np.zeros(CHOSEN + 1, np.int64)
    walk[TOP], walk[AHEAD] = -ABOVE, -1
    tiles = np.zeros((2 * BLOCK // machine.pixels, SIDE), np.int64)
    dirty_bits = np.zeros((machine.lines, machine.half_words), np.bool_)
    return Lanes(tiles, np.zeros(1, np.int64), dirty_bits, walk)


@nb.njit(cache=True)
def _meets_row(tile: Any, line: int) -> bool:
    """Return whether a tile draws into the row of lanes of a line."""
    return tile[2 + (line - tile[0]) % SIDE] != 0


@nb.njit(cache=True)
def _lowest(bits: int) -> int:
    """Return the number of the lowest bit that is set, or 0."""
    number = 0
    while bits and not bits >> number & 1:
        number += 1
    return number


@nb.njit(cache=True)
def _compare(near: Any, ahead: int, missing: bool, machine: Machine) -> None:
    """Set whether the lines of the upper and of the lower tiles are in the window.

    ``ahead``: lines from the window's first to the element's. ``missing``: the element was not
    compared while the one before waited.
    """
    for lower in range(2):
        # Once all lines above the element have left, there is room in any case.
        room = max(machine.lines - SIDE - SIDE * lower, 1)
        near[lower] = not missing and ahead < room


@nb.njit(cache=True)
def least_lane_cycles(words: Any, pixels: int) -> Any:
    """Return the least cycles in which lanes can draw each element, one pixel a lane and cycle.

    Those are as many as its busiest lane has pixels. Its lanes are told apart by the
    places of their pixels in tiles. Clipping is left out.

    Parameters
    ----------
    words
        Code words of elements: shape (n,), int64.
    pixels
        Pixels of a word of the raster.

    Returns
    -------
    numpy.ndarray
        Shape (n,), int64.
    """
    tiles = np.zeros((2 * BLOCK // pixels, SIDE), np.int64)
    cycles = np.ones(len(words), np.int64)
    for i in range(len(words)):
        _cut(words[i], tiles, pixels)
        for k in range(SIDE):
            for j in range(pixels):
                wanted = 0
                for number in range(len(tiles)):
                    wanted += tiles[number, k] >> j & 1
                cycles[i] = max(cycles[i], wanted)
    return cycles


@nb.njit(cache=True)
def _cut(word: int, tiles: Any, pixels: int) -> tuple[int, int]:
    """Cut an element into its tiles; return which of them have a pixel, clipped away or not.

    And by how many columns its lower tiles lie further right, 0 or 1.
    """
    tiles[:] = 0
    across = BLOCK // pixels
    whole = (1 << pixels) - 1
    rows = np.empty((BLOCK, 2), np.int64)
    right = unfold(word, rows)
    for row in range(BLOCK):
        first, last = rows[row]
        if first > last:
            continue
        lower = row // SIDE
        columns = ((2 << last) - (1 << first)) >> right * lower
        for number in range(across):
            tiles[across * lower + number, row % SIDE] = columns >> number * pixels & whole
    left = 0
    for number in range(len(tiles)):
        left |= int(tiles[number].any()) << number
    return left, right


@nb.njit(cache=True)
def _clip(
    columns: Any, top: int, x: int, right: int, number: int, tile: Any, machine: Machine
) -> None:
    """Set ``tile``: first line and column, what of each line lies in the image, and first word.

    Of columns, what lies in the image's words.
    """
    pixels = machine.pixels
    across = BLOCK // pixels
    lower = number // across
    line, column = top + SIDE * lower, x + pixels * (number % across)
    tile[2 + SIDE] = column // pixels
    column += right * lower
    tile[0], tile[1] = line, column
    # A tile that begins right of the image has no column.
    room = max((machine.last_column // pixels + 1) * pixels - column, 0)
    inside = (1 << min(room, pixels)) - 1
    for k in range(SIDE):
        tile[2 + k] = columns[k] & inside if 0 <= line + k <= machine.last_line else 0


@nb.njit(cache=True)
def _meet(tile: Any, other: Any, machine: Machine) -> bool:
    """Return whether two tiles overlap, as the circuit sees it: by their places in the window."""
    lines, columns = machine.lines, machine.pixels * 2 * machine.half_words
    line, column = (tile[0] - other[0]) % lines, (tile[1] - other[1]) % columns
    return min(line, lines - line) < SIDE and min(column, columns - column) < machine.pixels


@nb.njit(cache=True)
def _mark(tile: Any, lanes: Lanes, machine: Machine) -> None:
    """Mark the words that a tile is drawn into."""
    for k in range(SIDE):
        place, columns = (tile[0] + k) % machine.lines, tile[2 + k]
        for j in range(machine.pixels):
            if columns >> j & 1:
                lanes.dirty_bits[place, (tile[1] + j) // (machine.pixels * PAIR)] = True
                lanes.walk[WRITTEN] |= 1 << place


@nb.njit(cache=True)
def _reach(tile: Any, machine: Machine) -> int:
    """Return the stretches that a tile's two words lie in, a bit each, whatever it draws there."""
    words = 2 * machine.half_words
    word = tile[2 + SIDE]
    reach = 0
    for number in (word % words, (word + 1) % words):
        reach |= 1 << number // STRETCH
    return reach


@nb.njit(cache=True)
def _step(lanes: Lanes, flushing: bool, reach: int, enable: bool, machine: Machine) -> None:
    """Move the flush scan on: by a word, a stretch, a line, or over all lines not written."""
    walk, dirty_bits = lanes.walk, lanes.dirty_bits
    oldest = walk[OLDEST]
    place = oldest % len(dirty_bits)
    leaving, written = oldest < walk[TOP], walk[WRITTEN] >> place & 1
    wanted = (walk[NOW] | walk[BEFORE]) & walk[AHEAD]
    walks = leaving and written and walk[PAIRS] == 0
    single = machine.flush_words == 1
    moves = not walk[ASKING] or (flushing and (walk[SECOND] or not single))
    taking, left = walk[TAKING], walks and moves and not wanted
    walk[TAKING] = walks and wanted and enable and not taking
    walk[FLUSHED] = flushing
    if flushing and single:
        walk[SECOND] ^= 1
    if moves:
        walk[ASKING] = walk[PAIRS] > 0
        walk[PAIRS] -= walk[ASKING]
    if taking:
        stretch = walk[CHOSEN]
        found = dirty_bits[place, stretch * STRETCH // PAIR : (stretch + 1) * STRETCH // PAIR]
        walk[PAIRS] = found.sum()
        found[:] = False
        walk[AHEAD] &= ~(1 << stretch)
    if wanted:
        walk[CHOSEN] = 0
        while not wanted >> walk[CHOSEN] & 1:
            walk[CHOSEN] += 1
    turn = oldest // len(dirty_bits) % 2
    if walk[WRITTEN] == 0:
        walk[NOW] = walk[BEFORE] = 0
    elif turn != walk[TURN]:
        walk[BEFORE], walk[NOW] = walk[NOW], 0
    walk[NOW] |= reach
    walk[TURN] = turn
    if leaving and walk[WRITTEN] == 0:
        walk[OLDEST] = walk[TOP]
    elif left or (leaving and not written):
        walk[OLDEST] = oldest + 1
    if left:
        walk[AHEAD] = -1
        walk[WRITTEN] &= ~(1 << place)
