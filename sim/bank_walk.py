"""The clock of the walker of a window of banks: which words leave, line by line.

It reads the marks of a stretch of words at a time, ahead of the words that it asks for.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from .pipeline_model import EMPTY, LINES, Machine

__all__ = [
    "ASKED",
    "FRONT",
    "LINE",
    "OLDEST",
    "PAIR",
    "REACHED",
    "STRETCH",
    "TOP",
    "WRITTEN",
    "asked_banks",
    "bank_of",
    "is_clean",
    "new_walk",
    "step_walk",
]

STRETCH = 16
"""Words whose marks are read together."""

(
    OLDEST,
    LINE,
    ROW,
    ROW_LINE,
    ROW_STRETCH,
    LEFT,
    LEFT_LINE,
    LEFT_STRETCH,
    WRITTEN,
    TOP,
    REACHED,
    AHEAD,
    CHOSEN,
    LAST,
    ASKED,
    PAIR,
    BEHIND,
    BEHIND_PAIR,
    BEHIND_LINE,
    FRONT,
) = range(20)
"""Registers of the walker: the first line in the window; the line whose marks are
read next; the marks that were read and wait, their line and stretch; those of the words that are
still to be asked for; a bit a place that was written into;
the line above which all lines are complete; stretches that elements reached since the window was
last clean, and those that the line still has, a bit each; the stretch that is read next, and
whether it is its line's last; the word that is asked for, on line ``OLDEST``, or ``EMPTY``, and
whether the one on its right is too; the same of the one asked for behind it, and its line; the
first line in the window as elements know it."""


@nb.njit(cache=True)
def new_walk(top: int) -> Any:
    """Return the registers as they are before the first code word; no element is above ``top``."""
    walk = np.zeros(FRONT + 1, np.int64)
    walk[TOP], walk[AHEAD], walk[ASKED], walk[BEHIND] = top, -1, EMPTY, EMPTY
    return walk


@nb.njit(cache=True, inline="always")
def _first_left(walk: Any) -> int:
    """Return the number of the first word that is left; there is one."""
    number = walk[LEFT_STRETCH] * STRETCH
    left = walk[LEFT]
    while not left & 1:
        left >>= 1
        number += 1
    return int(number)


@nb.njit(cache=True, inline="always")
def bank_of(line: int, number: int, machine: Machine) -> int:
    """Return the bank of a word of a line, as ``rtl/bank_layout.py`` says."""
    half = machine.half_banks
    if half == 4:
        return int((line + half * (number % 2)) % (2 * half))
    return int(line % half + half * (number % 2))


@nb.njit(cache=True)
def asked_banks(walk: Any, machine: Machine) -> int:
    """Return the banks that words are to leave from, or else both of the line, a bit each.

    No word that leaves is ever one that its bank writes at the moment, or draws in the next cycle:
    its line was complete a cycle before, and its place is not used again until it has left.
    """
    half = machine.half_banks
    if walk[ASKED] == EMPTY or walk[PAIR]:
        return (1 << half | 1) << int(walk[OLDEST] % half)
    return 1 << bank_of(walk[OLDEST], walk[ASKED], machine)


@nb.njit(cache=True)
def is_clean(walk: Any) -> bool:
    """Return whether nothing in the window is written."""
    left = walk[ROW] | walk[LEFT]
    return walk[WRITTEN] == 0 and left == 0 and walk[ASKED] == EMPTY


@nb.njit(cache=True)
def step_walk(
    walk: Any,
    marks: Any,
    complete: int,
    flushed: bool,
    marking: bool,
    idle: bool,
    machine: Machine,
) -> None:
    """Move the walker on: by a word, a stretch, a line, or over all lines if none is written.

    Parameters
    ----------
    walk
        The walker's registers, changed: see ``OLDEST``; shape (20,), int64.
    marks
        Words that were drawn into, changed: shape (16, words), bool.
    complete
        The line above which all lines are complete.
    flushed
        What is asked for leaves in this cycle.
    marking
        The marks of the line to be read are in use.
    idle
        Nothing is drawn or dealt: ``FRONT`` may be known before the last word has left.
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

    _ask(walk, flushed, complete, idle, machine)
    free = walk[LEFT] == 0 or walk[ROW] == 0
    if walk[LEFT] == 0:
        walk[LEFT], walk[LEFT_STRETCH] = walk[ROW], walk[ROW_STRETCH]
        walk[LEFT_LINE] = walk[ROW_LINE]
        walk[ROW] = 0
    if walk[LEFT] == 0:
        walk[LEFT], walk[LEFT_LINE], walk[LEFT_STRETCH] = row, line, stretch
    elif free:
        walk[ROW], walk[ROW_LINE], walk[ROW_STRETCH] = row, line, stretch
    if scans and free:
        marks[line % LINES, stretch * STRETCH : (stretch + 1) * STRETCH] = False
        walk[AHEAD] &= ~(1 << stretch)
        if walk[LAST]:
            walk[AHEAD] = -1
            walk[WRITTEN] &= ~here
            walk[LINE] += 1
    elif leaving and walk[WRITTEN] == 0:
        walk[LINE] = complete
    elif leaving and not walk[WRITTEN] & here:
        walk[LINE] += 1
    wanted = walk[REACHED] & walk[AHEAD]
    chosen = 0
    while wanted and not wanted >> chosen & 1:
        chosen += 1
    # Of 64 stretches the last one is the sign, which a shift would spread.
    walk[CHOSEN], walk[LAST] = chosen, wanted & (wanted - 1) == 0


@nb.njit(cache=True)
def _ask(walk: Any, flushed: bool, complete: int, idle: bool, machine: Machine) -> None:
    """Take a word, or a pair, out of those that are left, and let what is asked for move on."""
    leaving = walk[LINE] < complete
    asked, pair, line = EMPTY, 0, walk[LEFT_LINE]
    if walk[LEFT] and walk[BEHIND] == EMPTY:
        asked = _first_left(walk)
        walk[LEFT] &= walk[LEFT] - 1
        right = asked % STRETCH + 1
        if machine.raster_words == 2 and asked % 2 == 0 and walk[LEFT] >> right & 1:
            walk[LEFT] &= walk[LEFT] - 1
            pair = 1
    if walk[ASKED] != EMPTY and not flushed:
        if asked != EMPTY:
            walk[BEHIND], walk[BEHIND_PAIR], walk[BEHIND_LINE] = asked, pair, line
    elif walk[BEHIND] != EMPTY:
        walk[ASKED], walk[PAIR] = walk[BEHIND], walk[BEHIND_PAIR]
        walk[OLDEST], walk[BEHIND] = walk[BEHIND_LINE], EMPTY
        walk[FRONT] = walk[OLDEST]
    else:
        walk[ASKED], walk[PAIR] = asked, pair
        if asked != EMPTY:
            walk[OLDEST] = walk[FRONT] = line
        elif walk[ROW] == 0:
            walk[OLDEST] = walk[FRONT] = walk[LINE]
        last = walk[LEFT] == 0 and walk[ROW] == 0
        if idle and last and leaving and walk[WRITTEN] == 0:
            walk[FRONT] = complete
