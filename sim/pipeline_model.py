"""The engine's clock, as a program: what each stage holds from cycle to cycle.

It follows the circuit of ``rtl/`` stage by stage, but only in what decides about time: which code
word stands where, which banks it still needs, and which lines are on their way out. Depths and
colours do not matter, as long as a colour has one plane: then a word takes a bank for one cycle
whether its pixels pass or not. (With further planes a bank in which a pixel passes is busy for
another cycle. That model would keep a depth buffer beside ``Window`` and count in ``_draw``.)

All ports are willing in every cycle and there is no initial raster.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from ..rtl.format import BLOCK, PAPER, ROWS, EngineConfig

__all__ = ["Machine", "machine_of", "walk"]

BANKS = 8
LINES = PAPER.window_lines
"""Lines of the window."""

WORD = PAPER.pixels_per_word
"""Pixels in a word of memory."""

NEIGHBOURS = 3
"""Words of a line that a block can touch."""

SEQUENCER, DECODER = 0, 4
"""The pipeline's first and last stage; between them are the three of the colour unit."""

EMPTY = -1
"""In place of a code word's index: a stage holds none; in place of an address: a bank rests."""

ABOVE = BLOCK // 2

# The scans have the same place in every configuration, so that the compiler may know it.
FIRST = tuple(PAPER.first(row).lsb for row in range(ROWS))
LAST = tuple(PAPER.last(row).lsb for row in range(ROWS))
COLUMN = PAPER.first(0).mask


class Machine(NamedTuple):
    """What the clock depends on beside the code words.

    Parameters
    ----------
    x_lsb, x_mask, end_lsb
        Places of a code word's fields.
    last_column, last_line
        Size of the image less 1.
    lowest
        The line at which a block's top stays, far below every image.
    half_words
        Words of a line that a bank holds: half of them.
    clearing
        Cycles, from the first code word on, in which the window is still being cleared.
    hazard
        A bank cannot take the word that it writes at that moment. False is a machine that could.
    """

    x_lsb: int
    x_mask: int
    end_lsb: int
    last_column: int
    last_line: int
    lowest: int
    half_words: int
    clearing: int
    hazard: bool


def machine_of(config: EngineConfig, width: int, height: int, clearing: int = 0) -> Machine:
    """Return the machine of a configuration that draws an image of a size."""
    return Machine(
        x_lsb=config.x.lsb,
        x_mask=config.x.mask,
        end_lsb=config.control_end.lsb,
        last_column=width - 1,
        last_line=height - 1,
        lowest=(1 << (config.line_bits + 1)) - 1,
        half_words=1 << (config.word_bits - 1),
        clearing=clearing,
        hazard=True,
    )


class Window(NamedTuple):
    """The window's registers, as arrays.

    Parameters
    ----------
    left
        Slots of the element that each bank still has to draw, a bit a slot: shape (8,).
    address
        Address of each slot: shape (8, 3).
    taken
        The address that each bank took for drawing in the cycle before, or ``EMPTY``: shape (8,).
    ring
        See ``OLDEST`` and what follows: shape (5,).
    """

    left: Any
    address: Any
    taken: Any
    ring: Any


OLDEST, FLUSHED, WRITTEN, TOP, TOUCHED = range(5)
"""Registers of the ring: the first line in the window; how many of its words have been flushed; a
bit a place that was written into; the line above which all lines are complete. And the bits of the
places that the element at hand is written into."""


@nb.njit(cache=True)
def walk(words: Any, machine: Machine) -> int:
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
    window = Window(
        np.zeros(BANKS, np.int64),
        np.zeros((BANKS, NEIGHBOURS), np.int64),
        np.full(BANKS, EMPTY, np.int64),
        np.zeros(5, np.int64),
    )
    ring = window.ring
    ring[TOP] = -ABOVE
    held = np.full(DECODER + 1, EMPTY, np.int64)  # index of each stage's code word
    tops = np.zeros(DECODER + 1, np.int64)  # and its block's first line
    top = -ABOVE
    following = 0  # the next code word
    end_word = EMPTY
    leaving = False  # a flushed word stands on its bank's output
    cycle = 0
    while following < len(words) or end_word != EMPTY:
        clearing = cycle < machine.clearing
        head = held[DECODER]
        ends = head != EMPTY and head == end_word
        if ends and ring[WRITTEN] == 0 and not leaving:
            return cycle + 2  # the end beat is on the port in the next cycle

        near = tops[DECODER] - ring[OLDEST] < LINES - BANKS
        go = head != EMPTY and not ends and not clearing and near
        complete = ring[TOP]
        leaving = not clearing and _flushes(window, go)
        done = _draw(window, go, machine.hazard)
        if clearing:  # all banks, one address after the other; the last is the highest
            window.taken[:] = 4 * machine.half_words - 1
        _step_ring(ring, complete, leaving, go, machine)
        if head != EMPTY:
            ring[TOP] = tops[DECODER]

        # Every stage moves on if what it holds is taken or it holds nothing; the colour unit's
        # three stages as one.
        decoder_moves = head == EMPTY or done
        colour_moves = held[DECODER - 1] == EMPTY or decoder_moves
        sequencer_moves = held[SEQUENCER] == EMPTY or colour_moves
        if decoder_moves:
            held[DECODER], tops[DECODER] = held[DECODER - 1], tops[DECODER - 1]
            if held[DECODER] != EMPTY:
                ring[TOUCHED] = 0
                if held[DECODER] != end_word:
                    _place(words[held[DECODER]], tops[DECODER], window, machine)
        if colour_moves:
            for stage in range(DECODER - 1, SEQUENCER, -1):
                held[stage], tops[stage] = held[stage - 1], tops[stage - 1]
            held[SEQUENCER] = EMPTY
        if sequencer_moves and end_word == EMPTY:
            word = words[following]
            if not _is_control(word):
                held[SEQUENCER], tops[SEQUENCER] = following, top
            elif word >> machine.end_lsb & 1:
                held[SEQUENCER], tops[SEQUENCER] = following, machine.lowest
                end_word = following
            else:
                top = min(top + (word >> machine.x_lsb & machine.x_mask), machine.lowest)
            following += 1
        cycle += 1
    return 0


@nb.njit(cache=True)
def _place(word: int, top: int, window: Window, machine: Machine) -> None:
    """Deal the words of memory that an element touches to the banks: ``left``, ``address``.

    Words and lines outside the image are left out.
    """
    x = word >> machine.x_lsb & machine.x_mask
    for row in range(ROWS):
        first, last = word >> FIRST[row] & COLUMN, word >> LAST[row] & COLUMN
        if first > last:
            continue
        _place_row(top + row, x + first, x + last, x // WORD, window, machine)
        if word & 1 == 0:  # the row turned by 180 degrees
            begin, end = x + BLOCK - 1 - last, x + BLOCK - 1 - first
            _place_row(top + BLOCK - 1 - row, begin, end, x // WORD, window, machine)


@nb.njit(cache=True, inline="always")
def _place_row(
    line: int, begin: int, end: int, outermost: int, window: Window, machine: Machine
) -> None:
    """Deal the words of the columns ``begin .. end`` of a line; slot 0 is word ``outermost``."""
    if line < 0 or line > machine.last_line:
        return
    rightmost = min(end, machine.last_column) // WORD
    for number in range(begin // WORD, rightmost + 1):
        bank = (line + 4 * (number % 2)) % BANKS
        slot = number - outermost
        window.left[bank] |= 1 << slot
        window.address[bank, slot] = _address(line, number, machine)
        window.ring[TOUCHED] |= 1 << line % LINES


@nb.njit(cache=True, inline="always")
def _address(line: int, number: int, machine: Machine) -> int:
    """Return where a bank has a word of a line: any number of its own will do."""
    return line // 4 % 4 * machine.half_words + number // 2


@nb.njit(cache=True)
def _draw(window: Window, go: bool, hazard: bool) -> bool:
    """Let each bank take a word of the element, its leftmost, and return whether all are taken."""
    done = go
    for bank in range(BANKS):
        left = window.left[bank]
        if not go or left == 0:
            window.taken[bank] = EMPTY
            continue
        slot = 0 if left & 1 else 1 if left & 2 else 2
        address = window.address[bank, slot]
        if hazard and window.taken[bank] == address:
            window.taken[bank] = EMPTY
            done = False
            continue
        window.taken[bank] = address
        left &= left - 1
        window.left[bank] = left
        done = done and left == 0
    return done


@nb.njit(cache=True)
def _flushes(window: Window, go: bool) -> bool:
    """Return whether a word leaves in this cycle: the next one of the oldest line.

    It does if the line is complete and was written into, and the element does not need the bank.
    No word that leaves is ever one that its bank writes at the moment, or draws in the next cycle:
    the line was complete a cycle before, and its place is not used again until it has left.
    """
    ring = window.ring
    oldest = ring[OLDEST]
    if oldest >= ring[TOP] or not ring[WRITTEN] >> oldest % LINES & 1:
        return False
    bank = (oldest + 4 * (ring[FLUSHED] % 2)) % BANKS
    return not go or window.left[bank] == 0


@nb.njit(cache=True)
def _step_ring(ring: Any, complete: int, flushing: bool, go: bool, machine: Machine) -> None:
    """Move the window on: by a word, by an empty line, or over all lines if none is written."""
    oldest, written = ring[OLDEST], ring[WRITTEN]
    here = 1 << oldest % LINES
    if oldest < complete:
        if written == 0:
            ring[OLDEST] = complete
        elif not written & here:
            ring[OLDEST] = oldest + 1
        elif flushing and ring[FLUSHED] == machine.last_column // WORD:
            ring[OLDEST] = oldest + 1
            ring[FLUSHED] = 0
            written &= ~here
        elif flushing:
            ring[FLUSHED] += 1
    if go:
        written |= ring[TOUCHED]
    ring[WRITTEN] = written


@nb.njit(cache=True, inline="always")
def _is_control(word: int) -> bool:
    empty = True
    for row in range(ROWS):
        empty &= (word >> FIRST[row] & COLUMN) > (word >> LAST[row] & COLUMN)
    return (word & 1 == 1) & empty
