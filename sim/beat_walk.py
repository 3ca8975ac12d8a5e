"""The walker of rows of lanes: which lines leave, and which of their beats are asked for."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from .pipeline_model import ABOVE

__all__ = [
    "ASKED",
    "ASKING",
    "FLUSHED",
    "LINE",
    "TAKES",
    "TOP",
    "WRITTEN",
    "is_here",
    "new_walk",
    "oldest_of",
    "reached",
    "step_walk",
]

STRETCH = 4
"""Beats whose marks are taken together."""

(
    LINE,
    TOP,
    COMPLETE,
    WRITTEN,
    ASKING,
    ASKED,
    BEATS,
    FLUSHED,
    TAKES,
    AHEAD,
    FIRST,
    NOW,
    BEFORE,
    TURN,
) = range(14)
"""Registers of the walker: the line whose marks are taken next; the line above which all lines are
complete, and that of a cycle before; a bit a place that was written into; whether a beat is asked
for, and its line; how many are behind it; whether one left one cycle before, and whether marks were
about to be taken then; stretches that the line still has, a bit each, and the first of them that
was reached; stretches reached since the window moved on by its own height, and those before; and
which of these heights it is in, modulo 2."""


@nb.njit(cache=True)
def new_walk() -> Any:
    """Return the walker's registers before the first element: see ``LINE``."""
    walk = np.zeros(TURN + 1, np.int64)
    walk[TOP] = walk[COMPLETE] = -ABOVE
    walk[AHEAD] = -1
    return walk


@nb.njit(cache=True, inline="always")
def oldest_of(walk: Any) -> int:
    """Return the first line in the window."""
    return walk[ASKED] if walk[ASKING] else walk[LINE]


@nb.njit(cache=True, inline="always")
def is_here(walk: Any, lines: int) -> bool:
    """Return whether the line is complete and was written into."""
    return walk[LINE] < walk[COMPLETE] and walk[WRITTEN] >> walk[LINE] % lines & 1 == 1


@nb.njit(cache=True)
def reached(beat: int, next_beat: int, marks: Any) -> int:
    """Return the stretches, a bit each, that two beats of a line lie in."""
    beats = marks.shape[1]
    return 1 << beat % beats // STRETCH | 1 << next_beat % beats // STRETCH


@nb.njit(cache=True)
def step_walk(walk: Any, marks: Any, flushing: bool, reach: int, enable: bool) -> None:
    """Move the walker on: by a beat, a stretch, a line that has left, or over all not written.

    Parameters
    ----------
    walk
        Changed.
    marks
        Beats that were written, by place of their line: shape (lines, beats). Changed.
    flushing
        The beat that is asked for leaves.
    reach
        What ``reached`` says of the element that is offered.
    enable
        Marks may be taken.
    """
    line = walk[LINE]
    place = line % len(marks)
    leaving, here = line < walk[COMPLETE], is_here(walk, len(marks))
    known = walk[NOW] | walk[BEFORE]
    wanted, first = known & walk[AHEAD], walk[FIRST]
    moves = not walk[ASKING] or flushing
    take = here and first & wanted and walk[BEATS] == 0 and moves and enable
    walk[FLUSHED] = flushing
    walk[TAKES] = here
    if take:
        stretch = 0
        while not first >> stretch & 1:
            stretch += 1
        found = marks[place, stretch * STRETCH : (stretch + 1) * STRETCH]
        walk[BEATS] = found.sum()
        found[:] = False
        walk[ASKED] = line
        wanted &= ~first
        walk[AHEAD] &= ~first
    if moves:
        walk[ASKING] = walk[BEATS] > 0
        walk[BEATS] -= walk[ASKING]
    left = here and not wanted
    soon = wanted if wanted else known
    walk[FIRST] = soon & -soon
    turn = line // len(marks) % 2
    if walk[WRITTEN] == 0:
        walk[NOW] = walk[BEFORE] = 0
    elif turn != walk[TURN]:
        walk[BEFORE], walk[NOW] = walk[NOW], 0
    walk[NOW] |= reach
    walk[TURN] = turn
    if leaving and walk[WRITTEN] == 0:
        walk[LINE] = walk[COMPLETE]
    elif left or (leaving and not here):
        walk[LINE] = line + 1
    walk[COMPLETE] = walk[TOP]
    if left:
        walk[AHEAD] = -1
        walk[WRITTEN] &= ~(1 << place)
