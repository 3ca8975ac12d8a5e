"""The flush scan of rows of lanes: which lines leave, and which of their beats are asked for."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

__all__ = [
    "BEATS",
    "FLUSHED",
    "HERE",
    "LINE",
    "OLDEST",
    "WRITTEN",
    "new_walk",
    "reached",
    "step_walk",
]

STRETCH = 4
"""Beats whose marks are taken together."""

(
    LINE,
    HERE,
    EMPTY,
    WRITTEN,
    AHEAD,
    FIRST,
    BEATS,
    OLDEST,
    FLUSHED,
    NOW,
    BEFORE,
    TURN,
) = range(12)
"""Registers of the flush scan: the line whose marks are taken next, whether it is on its way out
and was written, or was not; a bit a place that was written into; stretches that the line still has,
a bit each, and the first of them; how many beats of the marks taken last are still asked for, and
their line, or else the first in the window; whether one left one cycle before; stretches reached
since the window moved on by its own height, and those before; and which of these heights it is in,
modulo 2."""


@nb.njit(cache=True)
def new_walk() -> Any:
    """Return the flush scan's registers before the first element: see ``LINE``."""
    walk = np.zeros(TURN + 1, np.int64)
    walk[AHEAD] = -1
    return walk


@nb.njit(cache=True)
def reached(beat: int, next_beat: int, dirty_bits: Any) -> int:
    """Return the stretches, a bit each, that two beats of a line lie in."""
    beats = dirty_bits.shape[1]
    return 1 << beat % beats // STRETCH | 1 << next_beat % beats // STRETCH


@nb.njit(cache=True)
def step_walk(
    walk: Any, dirty_bits: Any, top: int, flushing: bool, reach: int, enable: bool
) -> None:
    """Move the flush scan on: by a beat, a stretch, a line that has left, or over all not written.

    Parameters
    ----------
    walk
        Changed.
    marks
        Beats that were written, by place of their line: shape (lines, beats). Changed.
    top
        The lines above it are complete.
    flushing
        The beat that is asked for leaves.
    reach
        What ``reached`` says of the element that is offered.
    enable
        Marks may be taken.
    """
    line, here, empty = walk[LINE], walk[HERE], walk[EMPTY]
    place, lines = line % len(dirty_bits), len(dirty_bits)
    clean = walk[WRITTEN] == 0
    turns = walk[BEATS] - flushing <= 0
    known = walk[NOW] | walk[BEFORE]
    wanted, first = known & walk[AHEAD], walk[FIRST]
    rest = wanted & ~first
    take = here and turns and enable
    left = take and rest == 0
    looked_at = line + (here or empty)
    goes, jumps = left or empty, (empty or looked_at < top) and clean

    # The beats.
    walk[FLUSHED] = flushing
    walk[BEATS] -= flushing
    if turns:
        walk[OLDEST] = top if jumps else line
    if take:
        stretch = 0
        while not first >> stretch & 1:
            stretch += 1
        found = dirty_bits[place, stretch * STRETCH : (stretch + 1) * STRETCH]
        walk[BEATS] = found.sum()
        found[:] = False

    # The stretches.
    if take or not here:
        soon = rest if here and rest else known
        walk[FIRST] = soon & -soon
    if left:
        walk[AHEAD] = -1
    elif take:
        walk[AHEAD] = rest
    turn = line // lines % 2
    if clean:
        walk[NOW] = walk[BEFORE] = 0
    elif turn != walk[TURN]:
        walk[BEFORE], walk[NOW] = walk[NOW], 0
    walk[NOW] |= reach
    walk[TURN] = turn

    # The line.
    if goes or not (here or empty):
        leaving = looked_at < top and not jumps
        written = walk[WRITTEN] >> looked_at % lines & 1
        walk[HERE], walk[EMPTY] = leaving and written, leaving and not written
    if left:
        walk[WRITTEN] &= ~(1 << place)
    if jumps:
        walk[LINE] = top
    elif goes:
        walk[LINE] = line + 1
