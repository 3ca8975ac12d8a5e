"""The clock of the walker of a window of banks: which words leave, line by line.

It reads the marks of a stretch of words at a time, ahead of the words that it asks for.
"""

from __future__ import annotations

from typing import Any

import numba as nb

from .pipeline_model import LINES, Machine

__all__ = [
    "AHEAD",
    "BANKS",
    "LEFT",
    "LINE",
    "OLDEST",
    "REACHED",
    "STRETCH",
    "TOP",
    "WRITTEN",
    "asked_banks",
    "asked_word",
    "is_clean",
    "step_walk",
]

BANKS = 8

STRETCH = 16
"""Words whose marks are read together."""

(
    OLDEST,
    LINE,
    NEXT,
    NEXT_LINE,
    NEXT_STRETCH,
    LEFT,
    LEFT_STRETCH,
    WRITTEN,
    TOP,
    REACHED,
    AHEAD,
    CHOSEN,
    LAST,
) = range(13)
"""Registers of the walker: the first line in the window; the line whose marks are
read next; the marks of the stretch that follows, its line and number; those of the words that are
still to be asked for, and their stretch, on line ``OLDEST``; a bit a place that was written into;
the line above which all lines are complete; stretches that elements reached since the window was
last clean, and those that the line still has, a bit each; the stretch that is read next, and
whether it is its line's last."""


@nb.njit(cache=True, inline="always")
def asked_word(walk: Any) -> int:
    """Return the number of the word that is to leave next; there is one."""
    number = walk[LEFT_STRETCH] * STRETCH
    left = walk[LEFT]
    while not left & 1:
        left >>= 1
        number += 1
    return int(number)


@nb.njit(cache=True)
def asked_banks(walk: Any, machine: Machine) -> int:
    """Return the banks that words are to leave from, or else both of their line, a bit each.

    No word that leaves is ever one that its bank writes at the moment, or draws in the next cycle:
    its line was complete a cycle before, and its place is not used again until it has left.
    """
    if walk[LEFT] == 0:
        return 0b10001 << int(walk[OLDEST] % (BANKS // 2))
    number = asked_word(walk)
    banks = 1 << int((walk[OLDEST] + 4 * (number % 2)) % BANKS)
    if machine.raster_words == 2 and _with_next(walk):
        banks |= 1 << int((walk[OLDEST] + 4 * (1 - number % 2)) % BANKS)
    return banks


@nb.njit(cache=True, inline="always")
def _with_next(walk: Any) -> bool:
    """Return whether the next word is the left one of a pair whose right one is to leave too."""
    number = asked_word(walk)
    return number % 2 == 0 and walk[LEFT] >> (number % STRETCH + 1) & 1 == 1


@nb.njit(cache=True)
def is_clean(walk: Any) -> bool:
    """Return whether nothing in the window is written."""
    return walk[WRITTEN] == 0 and walk[NEXT] == 0 and walk[LEFT] == 0


@nb.njit(cache=True)
def step_walk(
    walk: Any, marks: Any, complete: int, flushed: bool, marking: bool, machine: Machine
) -> None:
    """Move the walker on: by a word, a stretch, a line, or over all lines if none is written.

    Parameters
    ----------
    walk
        The walker's registers, changed: see ``OLDEST``; shape (13,), int64.
    marks
        Words that were drawn into, changed: shape (16, words), bool.
    complete
        The line above which all lines are complete.
    flushed
        The word asked for leaves in this cycle.
    marking
        The marks of the line to be read are in use.
    machine
        The engine.
    """
    line, stretch = walk[LINE], walk[CHOSEN]
    leaving = line < complete
    here = 1 << line % LINES
    scans = leaving and walk[WRITTEN] & here and not marking
    row = 0
    if scans:
        first = stretch * STRETCH
        for number in range(first, min(first + STRETCH, marks.shape[1])):
            row |= int(marks[line % LINES, number]) << (number - first)

    if flushed:
        if machine.raster_words == 2 and _with_next(walk):
            walk[LEFT] &= walk[LEFT] - 1
        walk[LEFT] &= walk[LEFT] - 1
    if walk[LEFT] == 0:
        walk[LEFT], walk[LEFT_STRETCH] = walk[NEXT], walk[NEXT_STRETCH]
        walk[OLDEST] = walk[NEXT_LINE]
        walk[NEXT] = 0
    free = walk[NEXT] == 0
    if free:
        walk[NEXT_LINE], walk[NEXT_STRETCH] = line, stretch
    if scans and (free or row == 0):
        walk[NEXT] |= row
        marks[line % LINES, stretch * STRETCH : (stretch + 1) * STRETCH] = False
        walk[AHEAD] &= ~(1 << stretch)
        if walk[LAST]:
            walk[AHEAD] = -1
            walk[LINE] += 1
            walk[WRITTEN] &= ~here
    elif leaving and walk[WRITTEN] == 0:
        walk[LINE] = complete
    elif leaving and not walk[WRITTEN] & here:
        walk[LINE] += 1
    wanted = walk[REACHED] & walk[AHEAD]
    chosen = 0
    while wanted and not wanted >> chosen & 1:
        chosen += 1
    walk[CHOSEN], walk[LAST] = chosen, wanted >> chosen <= 1
