"""The cycle model of the blocks engine's flush scan."""

from __future__ import annotations

from typing import Any

import numpy as np

from splatline.host.compiled_cache import cached_njit

__all__ = [
    "BEATS",
    "FLUSHED",
    "HERE",
    "LINE",
    "OLDEST",
    "WRITTEN",
    "new_scan",
    "reached",
    "step_scan",
]

STRETCH = 4
"""Beats of a stretch, whose dirty bits are taken together."""

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
"""Registers of the flush scan.

- ``LINE``: the line whose dirty bits are taken next.
- ``HERE``, ``EMPTY``: it is retired, and dirty or clean.
- ``WRITTEN``: dirty lines, a bit a slot.
- ``AHEAD``: stretches of the line that are still to be taken, a bit each.
- ``FIRST``: the next of them, a bit.
- ``BEATS``: dirty beats of the stretch taken last that are still to be requested.
- ``OLDEST``: their line, or the first line in the window if there are none.
- ``FLUSHED``: a beat was flushed in the cycle before.
- ``NOW``, ``BEFORE``: stretches reached in this lap of the window, and in the one before.
- ``TURN``: number of the lap modulo 2.
"""


@cached_njit()
def new_scan() -> Any:
    """Return the flush scan's registers after reset."""
    scan = np.zeros(TURN + 1, np.int64)
    scan[AHEAD] = -1
    return scan


@cached_njit()
def reached(beat: int, next_beat: int, dirty_bits: Any) -> int:
    """Return the stretches of two beats of a line, a bit each."""
    beats = dirty_bits.shape[1]
    return 1 << beat % beats // STRETCH | 1 << next_beat % beats // STRETCH


@cached_njit()
def step_scan(
    scan: Any, dirty_bits: Any, top: int, flushing: bool, reach: int, enable: bool
) -> None:
    """Advance the flush scan by a cycle: by a beat, a stretch, a line, or over all clean lines.

    Parameters
    ----------
    scan
        Its registers. Changed.
    dirty_bits
        Dirty beats, by slot of their line: shape (lines, beats). Changed.
    top
        Lines above it are complete.
    flushing
        The requested beat is flushed.
    reach
        Stretches of the offered element, see ``reached``.
    enable
        Dirty bits may be taken.
    """
    line, here, empty = scan[LINE], scan[HERE], scan[EMPTY]
    place, lines = line % len(dirty_bits), len(dirty_bits)
    clean = scan[WRITTEN] == 0
    turns = scan[BEATS] - flushing <= 0
    known = scan[NOW] | scan[BEFORE]
    wanted, first = known & scan[AHEAD], scan[FIRST]
    rest = wanted & ~first
    take = here and turns and enable
    left = take and rest == 0
    looked_at = line + (here or empty)
    goes, jumps = left or empty, (empty or looked_at < top) and clean

    # The beats.
    scan[FLUSHED] = flushing
    scan[BEATS] -= flushing
    if turns:
        scan[OLDEST] = top if jumps else line
    if take:
        stretch = 0
        while not first >> stretch & 1:
            stretch += 1
        found = dirty_bits[place, stretch * STRETCH : (stretch + 1) * STRETCH]
        scan[BEATS] = found.sum()
        found[:] = False

    # The stretches.
    if take or not here:
        soon = rest if here and rest else known
        scan[FIRST] = soon & -soon
    if left:
        scan[AHEAD] = -1
    elif take:
        scan[AHEAD] = rest
    turn = line // lines % 2
    if clean:
        scan[NOW] = scan[BEFORE] = 0
    elif turn != scan[TURN]:
        scan[BEFORE], scan[NOW] = scan[NOW], 0
    scan[NOW] |= reach
    scan[TURN] = turn

    # The line.
    if goes or not (here or empty):
        leaving = looked_at < top and not jumps
        written = scan[WRITTEN] >> looked_at % lines & 1
        scan[HERE], scan[EMPTY] = leaving and written, leaving and not written
    if left:
        scan[WRITTEN] &= ~(1 << place)
    if jumps:
        scan[LINE] = top
    elif goes:
        scan[LINE] = line + 1
