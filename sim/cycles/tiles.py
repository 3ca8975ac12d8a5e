"""The cycle model of the tiles engine's window: tiles, arbitration and flush scan.

It follows neither colours nor depths: a pixel that fails the depth test takes the same time. Of a
plane it looks at the pixels beyond the background's depth, which are none of their tile.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from splatline.contract.codeword import decode_plane_word, decode_word
from splatline.contract.config import BLOCK
from splatline.contract.plane import SHIFTS, SUM_FRACTION, Z_FRACTION
from splatline.host.compiled_cache import cached_njit

from .front import ABOVE, EMPTY, END_WORD, FIRST_STAGE, FOLLOWING, HEAD, Machine, advance, new_front

__all__ = ["NO_TRACE", "count_tiles", "least_lane_cycles"]

SIDE = 4
"""Lines of a tile. Its columns are as many as a window word's pixels."""

STRETCH = 32
"""Window words of a stretch, whose dirty bits are taken together."""

PAIR = 2
"""Window words of a dirty bit."""

NO_TRACE = np.empty((0, 3), np.int64)
"""Given to :func:`count_tiles` where cycles are only counted."""

NOTHING, TILE, END = range(3)
"""Kinds of offers to the window: nothing, a tile or the end of the frame."""


class Lanes(NamedTuple):
    """The window's registers, as arrays.

    Parameters
    ----------
    tiles
        Columns of the element at the tiler, a bit each from its X on, not clipped: shape (tiles,
        4), by tile (upper ones from the left, then lower ones) and line of the tile.
    left
        Its tiles that are still to give, a bit each: shape (1,).
    dirty_bits
        Dirty pairs of words, by slot of their line: shape (lines, pairs).
    scan
        Registers of the flush scan, from ``OLDEST`` to ``CHOSEN``: shape (13,).
    """

    tiles: Any
    left: Any
    dirty_bits: Any
    scan: Any


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
"""Registers of the flush scan.

- ``OLDEST``: the first line in the window.
- ``TOP``: lines above it are complete.
- ``WRITTEN``: dirty lines, a bit a slot.
- ``PAIRS``: dirty pairs of the stretch taken last that are still to be requested.
- ``SECOND``: the second word of the requested pair is next.
- ``AHEAD``: stretches of the line that are still to be taken, a bit each.
- ``FLUSHED``: a word was flushed in the cycle before.
- ``TAKING``: dirty bits are taken in this cycle.
- ``ASKING``: a pair is requested.
- ``NOW``, ``BEFORE``: stretches reached in this lap of the window, and in the one before.
- ``TURN``: number of the lap modulo 2.
- ``CHOSEN``: the stretch that is taken next.
"""


@cached_njit()
def count_tiles(words: Any, highs: Any, machine: Machine, trace: Any) -> int:
    """Return the cycles from the first code word taken to the end beat, both included.

    Parameters
    ----------
    words, highs
        Code words, from :func:`splatline.sim.cycles.front.halves_of`.
    machine
        The engine and the image.
    trace
        Shape (n, 3), int64: of each of the first n cycles the code word at the tiler
        (``EMPTY``: none), ``TOP`` and ``OLDEST`` are written here. ``NO_TRACE``: of none.

    Returns
    -------
    int
        0 if there is no end word.
    """
    across = BLOCK // machine.pixels
    lanes = _new_lanes(machine)
    scan = lanes.scan
    tile, coming = np.zeros(3 + SIDE, np.int64), np.zeros(3 + SIDE, np.int64)
    planes = len(highs) > 0
    summed = NOTHING  # with planes: what is offered to the stage that sums them
    last_top = -ABOVE
    given, meets, drawn, ending, halfway = NOTHING, False, False, False, False
    lagging = False  # a flush has priority over a tile, as of the cycle before
    near = np.zeros(2, np.bool_)  # lines of upper and of lower tiles are in the window
    x, right = 0, 0
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        # The last pixels are cleared one cycle after their address.
        clearing, settling = cycle < machine.clearing, cycle <= machine.clearing
        if cycle < len(trace):
            trace[cycle, 0], trace[cycle, 1] = front.held[HEAD], scan[TOP]
            trace[cycle, 2] = scan[OLDEST]
        if ending and not (scan[FLUSHED] or halfway):
            return cycle + 2  # the end beat is on the port in the next cycle
        ending = given == END and scan[WRITTEN] == 0

        taking = scan[TAKING]
        oldest = scan[OLDEST]
        # A pair was flushed in the cycle before: its odd word is still to come, and no other pair
        # is flushed.
        halfway = machine.flush_words == PAIR and scan[FLUSHED]
        conflict = machine.hazard and meets and drawn
        meeting = given == TILE and _meets_row(tile, scan[OLDEST])
        # With pairs, dirty bits are taken beside a tile that does not use their row of lanes.
        waits = taking and (meeting or machine.flush_words == 1)
        going = given == TILE and not (settling or waits or conflict)
        first, lagging = lagging and not halfway, (scan[TOP] - scan[OLDEST]) % SIDE >= SIDE // 2
        flushing = scan[ASKING] and not (clearing or halfway) and (first or not meeting)
        going = going and not (scan[ASKING] and first and meeting)
        reach = _reach(tile, machine) if given == TILE else 0
        _step(lanes, flushing, reach, not clearing, machine)
        if going:
            _mark(tile, lanes, machine)
        drawn = going

        # The next tile, and the next element. Planes are summed in a stage of their own.
        done = False
        if planes and (given == NOTHING or going):
            meets = going and summed == TILE and _meet(coming, tile, machine)
            given, summed = summed, NOTHING
            tile[:] = coming
            scan[TOP] = last_top
        if summed == NOTHING if planes else given == NOTHING or going:
            head, top = front.held[HEAD], front.tops[HEAD]
            ends = head != EMPTY and head == front.state[END_WORD]
            left = lanes.left[0]
            number = _lowest(left)
            may = ends or near[0 if left & ((1 << across) - 1) else 1]
            made = END if ends else TILE if left and may else NOTHING
            if head != EMPTY:
                last_top = top
            if made == TILE:
                _clip(lanes.tiles[number], top, x, right, number, coming, machine)
                lanes.left[0] = left & (left - 1)
            if planes:
                summed = made
                if made == TILE:
                    _cut_beyond(highs[head], top, x, coming, machine)
            else:
                meets = going and made == TILE and _meet(coming, tile, machine)
                given = made
                tile[:] = coming
                scan[TOP] = last_top
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
                lanes.left[0], right = _cut(words, highs, head, lanes.tiles, machine.pixels)
        cycle += 1
    return 0


@cached_njit()
def _new_lanes(machine: Machine) -> Lanes:
    """Return the registers after reset."""
    scan = np.zeros(CHOSEN + 1, np.int64)
    scan[TOP], scan[AHEAD] = -ABOVE, -1
    tiles = np.zeros((2 * BLOCK // machine.pixels, SIDE), np.int64)
    dirty_bits = np.zeros((machine.lines, machine.half_words), np.bool_)
    return Lanes(tiles, np.zeros(1, np.int64), dirty_bits, scan)


@cached_njit()
def _meets_row(tile: Any, line: int) -> bool:
    """Return whether a tile draws into the row of lanes of a line."""
    return tile[2 + (line - tile[0]) % SIDE] != 0


@cached_njit()
def _lowest(bits: int) -> int:
    """Return the number of the lowest bit that is set, or 0."""
    number = 0
    while bits and not bits >> number & 1:
        number += 1
    return number


@cached_njit()
def _compare(near: Any, ahead: int, missing: bool, machine: Machine) -> None:
    """Set whether the lines of the upper and of the lower tiles are in the window.

    ``ahead``: lines from the window's first to the element's. ``missing``: the element was not
    compared while the one before waited.
    """
    for lower in range(2):
        # Once all lines above the element have left, there is room in any case.
        room = max(machine.lines - SIDE - SIDE * lower, 1)
        near[lower] = not missing and ahead < room


@cached_njit()
def least_lane_cycles(words: Any, highs: Any, pixels: int) -> Any:
    """Return the least cycles in which lanes can draw each element, one pixel a lane and cycle.

    These are the pixels of its busiest lane. Pixels at the same position of different tiles are in
    the same lane. Elements are not clipped.

    Parameters
    ----------
    words, highs
        Code words of elements, from :func:`splatline.sim.cycles.front.halves_of`: n of them.
    pixels
        Pixels of a window word.

    Returns
    -------
    numpy.ndarray
        Shape (n,), int64.
    """
    tiles = np.zeros((2 * BLOCK // pixels, SIDE), np.int64)
    cycles = np.ones(len(words), np.int64)
    for i in range(len(words)):
        _cut(words, highs, i, tiles, pixels)
        for k in range(SIDE):
            for j in range(pixels):
                wanted = 0
                for number in range(len(tiles)):
                    wanted += tiles[number, k] >> j & 1
                cycles[i] = max(cycles[i], wanted)
    return cycles


@cached_njit()
def _cut(words: Any, highs: Any, index: int, tiles: Any, pixels: int) -> tuple[int, int]:
    """Cut the element of a code word into its tiles.

    Return the tiles with a pixel, before clipping, a bit each; and by how many columns the lower
    tiles lie further right, 0 or 1.
    """
    tiles[:] = 0
    across = BLOCK // pixels
    whole = (1 << pixels) - 1
    rows = np.empty((BLOCK, 2), np.int64)
    right = 0
    if len(highs):
        decode_plane_word(words[index], highs[index], rows)
    else:
        right = decode_word(words[index], rows)
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


@cached_njit()
def _clip(
    columns: Any, top: int, x: int, right: int, number: int, tile: Any, machine: Machine
) -> None:
    """Set ``tile``: first line and column, the pixels of each line, and the first word.

    Lines are clipped to the image, and columns to its window words.
    """
    pixels = machine.pixels
    across = BLOCK // pixels
    lower = number // across
    line, column = top + SIDE * lower, x + pixels * (number % across)
    tile[2 + SIDE] = column // pixels
    column += right * lower
    tile[0], tile[1] = line, column
    # A tile right of the image has no column.
    room = max((machine.last_column // pixels + 1) * pixels - column, 0)
    inside = (1 << min(room, pixels)) - 1
    for k in range(SIDE):
        tile[2 + k] = columns[k] & inside if 0 <= line + k <= machine.last_line else 0


@cached_njit()
def _cut_beyond(high: int, top: int, x: int, tile: Any, machine: Machine) -> None:
    """Clear the pixels of a tile that lie beyond the background's depth."""
    plane = machine.plane
    shift = SHIFTS[high >> plane.scale_lsb & 3]
    top_bit = 64 - plane.slope_bits  # a slope is brought to the top of 64 bits and back
    a = (high << top_bit - plane.slope_x_lsb >> top_bit) << shift
    b = (high << top_bit - plane.slope_y_lsb >> top_bit) << shift
    start = (high >> plane.z_lsb & (1 << plane.z_bits) - 1) << SUM_FRACTION - Z_FRACTION
    beyond = (plane.background + 1) << SUM_FRACTION
    for k in range(SIDE):
        for j in range(machine.pixels):
            total = start + a * (tile[1] + j - x) + b * (tile[0] + k - top)
            tile[2 + k] &= ~(int(total >= beyond) << j)


@cached_njit()
def _meet(tile: Any, other: Any, machine: Machine) -> bool:
    """Return whether two tiles overlap, by slots and window words as the hardware compares them."""
    lines, columns = machine.lines, machine.pixels * 2 * machine.half_words
    line, column = (tile[0] - other[0]) % lines, (tile[1] - other[1]) % columns
    return min(line, lines - line) < SIDE and min(column, columns - column) < machine.pixels


@cached_njit()
def _mark(tile: Any, lanes: Lanes, machine: Machine) -> None:
    """Set the dirty bits of the words that a tile is drawn into."""
    for k in range(SIDE):
        place, columns = (tile[0] + k) % machine.lines, tile[2 + k]
        for j in range(machine.pixels):
            if columns >> j & 1:
                lanes.dirty_bits[place, (tile[1] + j) // (machine.pixels * PAIR)] = True
                lanes.scan[WRITTEN] |= 1 << place


@cached_njit()
def _reach(tile: Any, machine: Machine) -> int:
    """Return the stretches of a tile's two words, a bit each, with or without pixels there."""
    words = 2 * machine.half_words
    word = tile[2 + SIDE]
    reach = 0
    for number in (word % words, (word + 1) % words):
        reach |= 1 << number // STRETCH
    return reach


@cached_njit()
def _step(lanes: Lanes, flushing: bool, reach: int, enable: bool, machine: Machine) -> None:
    """Advance the flush scan by a cycle: by a word, a stretch, a line, or over all clean lines."""
    scan, dirty_bits = lanes.scan, lanes.dirty_bits
    oldest = scan[OLDEST]
    place = oldest % len(dirty_bits)
    leaving, written = oldest < scan[TOP], scan[WRITTEN] >> place & 1
    wanted = (scan[NOW] | scan[BEFORE]) & scan[AHEAD]
    scans = leaving and written and scan[PAIRS] == 0
    single = machine.flush_words == 1
    moves = not scan[ASKING] or (flushing and (scan[SECOND] or not single))
    taking, left = scan[TAKING], scans and moves and not wanted
    scan[TAKING] = scans and wanted and enable and not taking
    scan[FLUSHED] = flushing
    if flushing and single:
        scan[SECOND] ^= 1
    if moves:
        scan[ASKING] = scan[PAIRS] > 0
        scan[PAIRS] -= scan[ASKING]
    if taking:
        stretch = scan[CHOSEN]
        found = dirty_bits[place, stretch * STRETCH // PAIR : (stretch + 1) * STRETCH // PAIR]
        scan[PAIRS] = found.sum()
        found[:] = False
        scan[AHEAD] &= ~(1 << stretch)
    if wanted:
        scan[CHOSEN] = 0
        while not wanted >> scan[CHOSEN] & 1:
            scan[CHOSEN] += 1
    turn = oldest // len(dirty_bits) % 2
    if scan[WRITTEN] == 0:
        scan[NOW] = scan[BEFORE] = 0
    elif turn != scan[TURN]:
        scan[BEFORE], scan[NOW] = scan[NOW], 0
    scan[NOW] |= reach
    scan[TURN] = turn
    if leaving and scan[WRITTEN] == 0:
        scan[OLDEST] = scan[TOP]
    elif left or (leaving and not written):
        scan[OLDEST] = oldest + 1
    if left:
        scan[AHEAD] = -1
        scan[WRITTEN] &= ~(1 << place)
