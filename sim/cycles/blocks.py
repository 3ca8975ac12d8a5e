"""The cycle model of the blocks engine's window: stalls, arbitration and flush scan.

It follows neither colours nor depths: a pixel that fails the depth test takes the same time.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from splatline.contract.codeword import decode_plane_word, decode_word
from splatline.contract.config import BLOCK
from splatline.host.compiled_cache import cached_njit

from .blocks_flush import BEATS, FLUSHED, HERE, LINE, OLDEST, WRITTEN, new_scan, reached, step_scan
from .front import ABOVE, EMPTY, END_WORD, FOLLOWING, HEAD, Machine, advance, new_front

__all__ = ["count_blocks"]

QUEUED = 3
"""Cycles from the end beat's entry into the FIFO to its transfer on ``raster``."""

PAIR = 2
"""Words of a beat."""

NOTHING, ELEMENT, END = range(3)
"""Kinds of offers to the window: nothing, an element or the end of the frame."""

FIRST_LINE, COLUMN, ROWS = range(3)
"""State of an element: its block's first line and column; then the pixels of each row that lie in
the image, a bit a column."""

LAGGING = 2
"""A flush has priority over an element that begins so many lines or more below it, modulo 8."""


@cached_njit()
def count_blocks(words: Any, highs: Any, machine: Machine) -> int:
    """Return the cycles from the first code word taken to the end beat, both included.

    Parameters
    ----------
    words
        Code words: shape (n,), int64 (the bits of unsigned ones).
    highs
        The upper 32 bits of plane words: shape (n,), int64; shape (0,) without planes.
    machine
        The engine and the image.

    Returns
    -------
    int
        0 if there is no end word.
    """
    scan = new_scan()
    dirty_bits = np.zeros((machine.lines, machine.half_words), np.bool_)
    block = np.zeros(ROWS + BLOCK, np.int64)
    # The tiler's stages, as code words: rows rotated, block laid out, block offered.
    turned, turned_top = EMPTY, -ABOVE
    laid, laid_top = EMPTY, -ABOVE
    given, top, last_rows = NOTHING, -ABOVE, 0
    ending = False
    lagging = False  # a flush has priority over an element, as of the cycle before
    left, left_before = False, False  # a beat was flushed two cycles before, and three
    near = False  # the lines of the offered element are in the window
    cleared = 0  # the line of the beat that was flushed in the cycle before
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        if ending and not (scan[FLUSHED] or left or left_before):
            return cycle + QUEUED + 1
        left, left_before = scan[FLUSHED], left
        ending = given == END and scan[WRITTEN] == 0 and not scan[BEATS]

        oldest = scan[OLDEST]
        empties = scan[WRITTEN] == 0 and scan[BEATS] <= 1  # the window moves to ``top``
        first, lagging = lagging, (top - oldest) % BLOCK >= LAGGING
        # The element may use the row of lanes of the requested beat, or that of the dirty bits to
        # take. It stalls if one of these has priority. After reset the last pixels are cleared two
        # cycles after their address.
        offered = given == ELEMENT and near and cycle > machine.clearing + 1
        meets_beat = offered and block[ROWS + (oldest - block[FIRST_LINE]) % BLOCK]
        meets_marks = offered and block[ROWS + (scan[LINE] - block[FIRST_LINE]) % BLOCK]
        waits = first and ((scan[BEATS] and meets_beat) or (scan[HERE] and meets_marks))
        going = offered and not waits
        flushing = scan[BEATS] > 0 and (first or not meets_beat)
        enable = (first and scan[HERE]) or not meets_marks
        reach = 0
        if offered:
            word = block[COLUMN] // machine.pixels
            reach = reached(
                word // PAIR, (word + 1) % (PAIR * machine.half_words) // PAIR, dirty_bits
            )
        step_scan(scan, dirty_bits, top, flushing, reach, enable)
        if going:
            _mark(block, scan, dirty_bits, machine)

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
                _place(laid, words, highs, top, block, machine)
            laid, laid_top = turned, turned_top
            turned, turned_top = front.held[HEAD], front.tops[HEAD]
        advance(words, front, steps, machine, rigid=True)
        cycle += 1
    return 0


@cached_njit()
def _rows(word: int) -> int:
    """Return the lines that an element may have: 4 or 8."""
    return BLOCK // 2 if word & 1 else BLOCK


@cached_njit()
def _place(index: int, words: Any, highs: Any, top: int, block: Any, machine: Machine) -> None:
    """Set ``block`` to that of an element, clipped to the image, columns by whole words."""
    rows = np.empty((BLOCK, 2), np.int64)
    word = words[index]
    if len(highs):
        decode_plane_word(word, highs[index], rows)
    else:
        decode_word(word, rows)
    x = word >> machine.x_lsb & machine.x_mask
    block[FIRST_LINE], block[COLUMN] = top, x
    room = max((machine.last_column // machine.pixels + 1) * machine.pixels - x, 0)
    inside = (1 << min(room, BLOCK + 1)) - 1
    for row in range(BLOCK):
        first, last = rows[row]
        filled = first <= last and 0 <= top + row <= machine.last_line
        block[ROWS + row] = (2 << last) - (1 << first) & inside if filled else 0


@cached_njit()
def _mark(block: Any, scan: Any, dirty_bits: Any, machine: Machine) -> None:
    """Set the dirty bits of the beats that an element is drawn into."""
    for row in range(BLOCK):
        place, columns = (block[FIRST_LINE] + row) % machine.lines, block[ROWS + row]
        for column in range(BLOCK + 1):
            if columns >> column & 1:
                beat = (block[COLUMN] + column) // (machine.pixels * PAIR)
                dirty_bits[place, beat] = True
                scan[WRITTEN] |= 1 << place
