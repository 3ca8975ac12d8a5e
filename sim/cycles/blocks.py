"""The clock of a window of rows of lanes: an element a cycle, and which beats leave.

Neither colours nor depths matter: a lane takes as long for a pixel that does not pass.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from splatline.contract.codeword import unfold
from splatline.contract.config import BLOCK

from .blocks_flush import BEATS, FLUSHED, HERE, LINE, OLDEST, WRITTEN, new_walk, reached, step_walk
from .front import ABOVE, EMPTY, END_WORD, FOLLOWING, HEAD, Machine, advance, new_front

__all__ = ["walk_blocks"]

QUEUED = 3
"""Cycles from the one in which the end beat goes into the queue to the one in which it leaves."""

PAIR = 2
"""Words of a beat."""

NOTHING, ELEMENT, END = range(3)
"""What the window is given: nothing, an element or the end of the frame."""

FIRST_LINE, COLUMN, ROWS = range(3)
"""What is kept of an element: its block's first line and column, and from there on what of each row
lies in the image, a bit a column."""

LAGGING = 2
"""A line that leaves goes before an element if it lies so many lines above it, modulo a block's."""


@nb.njit(cache=True)
def walk_blocks(words: Any, machine: Machine) -> int:
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
    walk = new_walk()
    dirty_bits = np.zeros((machine.lines, machine.half_words), np.bool_)
    block = np.zeros(ROWS + BLOCK, np.int64)
    turned, turned_top = EMPTY, -ABOVE  # the code word whose rows are in the columns of lanes
    laid, laid_top = EMPTY, -ABOVE  # the one whose pixels are in lanes
    given, top, last_rows = NOTHING, -ABOVE, 0  # what the window is given
    ending = False
    lagging = False  # in the cycle before, for lines that leave to go before elements
    left, left_before = False, False  # a beat left two cycles before, and three
    near = False  # the lines of what the window is given are there
    cleared = 0  # the line of the beat that left in the cycle before
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        if ending and not (walk[FLUSHED] or left or left_before):
            return cycle + QUEUED + 1
        left, left_before = walk[FLUSHED], left
        ending = given == END and walk[WRITTEN] == 0 and not walk[BEATS]

        oldest = walk[OLDEST]
        empties = walk[WRITTEN] == 0 and walk[BEATS] <= 1  # and comes to ``top``
        first, lagging = lagging, (top - oldest) % BLOCK >= LAGGING
        # Whether the element wants the row of lanes of the beat that leaves, or marks of the row
        # of which some are taken; and whether it waits for the one or the other.
        # The last pixels to be cleared are written two cycles after the last address.
        offered = given == ELEMENT and near and cycle > machine.clearing + 1
        meets_beat = offered and block[ROWS + (oldest - block[FIRST_LINE]) % BLOCK]
        meets_marks = offered and block[ROWS + (walk[LINE] - block[FIRST_LINE]) % BLOCK]
        waits = first and ((walk[BEATS] and meets_beat) or (walk[HERE] and meets_marks))
        going = offered and not waits
        flushing = walk[BEATS] > 0 and (first or not meets_beat)
        enable = (first and walk[HERE]) or not meets_marks
        reach = 0
        if offered:
            word = block[COLUMN] // machine.pixels
            reach = reached(
                word // PAIR, (word + 1) % (PAIR * machine.half_words) // PAIR, dirty_bits
            )
        step_walk(walk, dirty_bits, top, flushing, reach, enable)
        if going:
            _mark(block, walk, dirty_bits, machine)

        # The next element.
        steps = given == NOTHING or going
        waiting = given != NOTHING and not near
        if given == END:
            near = False
        elif waiting or steps:
            wanted = top if waiting else laid_top
            rows = last_rows if waiting else BLOCK
            comes = waiting and empties and (oldest - wanted) % machine.lines >= rows
            clears = left and (cleared - wanted) % machine.lines < rows
            near = (wanted - oldest < machine.lines - BLOCK or comes) and not clears
        cleared = oldest
        if steps:
            given = NOTHING
            if laid != EMPTY:
                given, top = END if laid == front.state[END_WORD] else ELEMENT, laid_top
                last_rows = _rows(words[laid])
            if given == ELEMENT:
                _place(words[laid], top, block, machine)
            laid, laid_top = turned, turned_top
            turned, turned_top = front.held[HEAD], front.tops[HEAD]
        advance(words, front, steps, machine, rigid=True)
        cycle += 1
    return 0


@nb.njit(cache=True)
def _rows(word: int) -> int:
    """Return the lines from an element's first one on that it may be drawn into."""
    return BLOCK // 2 if word & 1 else BLOCK


@nb.njit(cache=True)
def _place(word: int, top: int, block: Any, machine: Machine) -> None:
    """Set ``block`` to an element's, clipped to the image: its columns to the image's words."""
    rows = np.empty((BLOCK, 2), np.int64)
    unfold(word, rows)
    x = word >> machine.x_lsb & machine.x_mask
    block[FIRST_LINE], block[COLUMN] = top, x
    room = max((machine.last_column // machine.pixels + 1) * machine.pixels - x, 0)
    inside = (1 << min(room, BLOCK + 1)) - 1
    for row in range(BLOCK):
        first, last = rows[row]
        filled = first <= last and 0 <= top + row <= machine.last_line
        block[ROWS + row] = (2 << last) - (1 << first) & inside if filled else 0


@nb.njit(cache=True)
def _mark(block: Any, walk: Any, dirty_bits: Any, machine: Machine) -> None:
    """Mark the beats that an element is drawn into."""
    for row in range(BLOCK):
        place, columns = (block[FIRST_LINE] + row) % machine.lines, block[ROWS + row]
        for column in range(BLOCK + 1):
            if columns >> column & 1:
                beat = (block[COLUMN] + column) // (machine.pixels * PAIR)
                dirty_bits[place, beat] = True
                walk[WRITTEN] |= 1 << place
