"""The clock of a window of banks: which banks an element still needs.

Colours do not matter, and depths only where colours have further planes: two cycles after a word in
which a pixel passed, or that was cleared and not all background, its bank reads them and takes
nothing else.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from ..host.unfold import unfold
from ..rtl.format import BLOCK
from .bank_walk import (
    ASKED,
    FRONT,
    LINE,
    OLDEST,
    REACHED,
    STRETCH,
    TOP,
    WRITTEN,
    asked_banks,
    bank_of,
    is_clean,
    new_walk,
    step_walk,
)
from .pipeline_model import (
    ABOVE,
    EMPTY,
    END_WORD,
    FIRST_STAGE,
    FOLLOWING,
    HEAD,
    LINES,
    Machine,
    advance,
    new_front,
)

__all__ = ["walk_banks"]

URGENT, URGENT_SOON = 6, 2
"""A word which leaves goes before the element where so many complete lines wait: with eight banks
six or seven, with sixteen two or more."""


class Window(NamedTuple):
    """The window's registers, as arrays.

    Parameters
    ----------
    left
        Slots of the decoder's element that each bank has still to be dealt, a bit a slot: shape
        (banks,).
    address
        Address of each slot: shape (banks, words).
    covered, place
        Pixels that the element covers of each slot's word, a bit each, and where that word starts
        in ``depth``: shape (banks, words).
    dealt
        The address that each bank is to draw at next, or ``EMPTY``: shape (banks,).
    dealt_covered, dealt_place
        What ``covered`` and ``place`` have of it: shape (banks,).
    taken
        The address that each bank took for drawing in the cycle before, or ``EMPTY``: shape
        (banks,).
    walk
        The walker's registers, see ``bank_walk.OLDEST``: shape (20,).
    marks
        Words that were drawn into, by place of their line: shape (16, words).
    depth
        Of every pixel of the image's words, if there are further planes: shape (pixels,).
    reading
        Banks that read further planes in this cycle and in the two that follow: shape (3, banks).
    leaving
        What was flushed one, two and three cycles before: nothing, ``BLANK`` or ``SHOWN``: shape
        (3,).
    """

    left: Any
    address: Any
    covered: Any
    place: Any
    dealt: Any
    dealt_covered: Any
    dealt_place: Any
    taken: Any
    walk: Any
    marks: Any
    depth: Any
    reading: Any
    leaving: Any


BLANK, SHOWN = 1, 2
"""A flushed word that is background, or not; it matters only where there are further planes."""


@nb.njit(cache=True)
def walk_banks(words: Any, machine: Machine) -> int:
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
    banks = 2 * machine.half_banks
    window = Window(
        np.zeros(banks, np.int64),
        np.zeros((banks, machine.block_words), np.int64),
        np.zeros((banks, machine.block_words), np.int64),
        np.zeros((banks, machine.block_words), np.int64),
        np.full(banks, EMPTY, np.int64),
        np.zeros(banks, np.int64),
        np.zeros(banks, np.int64),
        np.full(banks, EMPTY, np.int64),
        new_walk(-ABOVE),
        np.zeros((LINES, 2 * machine.half_words), np.bool_),
        np.full(_pixels(machine), machine.z_mask, np.int64),
        np.zeros((3, banks), np.int64),
        np.zeros(3, np.int64),
    )
    walk = window.walk
    dealt = EMPTY  # the code word of which the banks are dealt words
    top = offered_top = -ABOVE  # of what is dealt, or of what comes next; of the decoder's element
    near = waiting = closing = False
    front = new_front()
    cycle = 0
    while front.state[FOLLOWING] < len(words) or front.state[END_WORD] != EMPTY:
        clearing = cycle < machine.clearing
        drawn = _drawn(window, machine) if cycle > machine.clearing else 0
        head = front.held[HEAD]
        ends = head != EMPTY and head == front.state[END_WORD]
        closes = ends and dealt == EMPTY
        if closes and not drawn and is_clean(walk) and not _on_the_way(window, machine):
            return cycle + 2  # the end beat is on the port in the next cycle

        settled = machine.clearing == 0 or cycle > machine.clearing  # what was cleared last
        go = dealt != EMPTY and settled
        offered = head != EMPTY and near and not ends
        complete = machine.lowest if closing else walk[TOP]
        ready = not clearing and not (machine.planes > 1 and window.leaving[1] == SHOWN)
        asked = asked_banks(walk, machine)
        held = asked if waiting and ready else 0
        flushed = ready and walk[ASKED] != EMPTY
        for bank in range(banks):
            if flushed and asked >> bank & 1:
                flushed = window.reading[0, bank] == 0
                flushed &= not go or window.dealt[bank] == EMPTY or held != 0
        # The marks of its line are in use in the cycle after one of its banks was drawn into.
        first = walk[LINE] % machine.half_banks
        second = first + machine.half_banks
        marking = window.taken[first] != EMPTY or window.taken[second] != EMPTY
        ahead, oldest = top - walk[FRONT], walk[FRONT]
        if walk[WRITTEN] == 0 and not drawn and not go:
            walk[REACHED] = 0
        done = _draw(window, go, held, _depth(words, dealt, machine), machine)
        if clearing:  # all banks, one address after the other; the last is the highest
            window.reading[2, :] = machine.planes > 1  # what memory held at first is no background
        _shift(window, _give_up(window, machine) if flushed else 0)
        idle = not offered and dealt == EMPTY and not drawn
        idle = idle and not closing and machine.planes == 1
        step_walk(walk, window.marks, complete, flushed, marking, idle, machine)
        if machine.mark_words > 1:
            # All are read.
            walk[REACHED] = (2 << machine.last_column // (machine.pixels * STRETCH)) - 1
        elif go:
            walk[REACHED] |= _reach(words[dealt], machine)
        walk[WRITTEN] |= drawn

        step = dealt == EMPTY or done
        dealt_last = _deal(window, offered) if step else False
        walk[TOP] = top
        if step:
            dealt = head if offered else EMPTY
            top = offered_top
        # More than seven wait only where nothing is dealt.
        waiting = ahead >= URGENT_SOON
        if machine.half_banks == 4:
            waiting = ahead >= 0 and ahead & URGENT == URGENT
        closing = closing or closes
        waits = head != EMPTY and not near
        coming = front.tops[HEAD if waits else FIRST_STAGE]
        moves = advance(words, front, dealt_last, machine)
        if ends:
            near = False
        elif waits or moves:
            near = coming - oldest < LINES - BLOCK
        if moves and front.held[HEAD] != EMPTY:
            head = front.held[HEAD]
            offered_top = front.tops[HEAD]
            if head != front.state[END_WORD]:
                _place(words[head], offered_top, window, machine)
        cycle += 1
    return 0


@nb.njit(cache=True, inline="always")
def _depth(words: Any, index: int, machine: Machine) -> int:
    """Return the depth of a code word, if there is one."""
    return int(words[index] >> machine.z_lsb & machine.z_mask) if index != EMPTY else 0


@nb.njit(cache=True, inline="always")
def _reach(word: int, machine: Machine) -> int:
    """Return the stretches that an element's words may lie in, a bit each."""
    number = (word >> machine.x_lsb & machine.x_mask) // machine.pixels
    stretches = 1 << number // STRETCH
    last = machine.block_words - 1
    if number % STRETCH + last >= STRETCH and number + last < 2 * machine.half_words:
        stretches |= 2 << number // STRETCH  # its last word may lie in the next
    return int(stretches)


@nb.njit(cache=True)
def _place(word: int, top: int, window: Window, machine: Machine) -> None:
    """Deal the words of memory that an element touches to the banks: ``left``, ``address``.

    Words and lines outside the image are left out.
    """
    x = word >> machine.x_lsb & machine.x_mask
    rows = np.empty((BLOCK, 2), np.int64)
    unfold(word, rows)
    for row in range(BLOCK):
        first, last = rows[row]
        if first <= last:
            _place_row(top + row, x + first, x + last, x // machine.pixels, window, machine)


@nb.njit(cache=True, inline="always")
def _place_row(
    line: int, begin: int, end: int, outermost: int, window: Window, machine: Machine
) -> None:
    """Deal the words of the columns ``begin .. end`` of a line; slot 0 is word ``outermost``."""
    if line < 0 or line > machine.last_line:
        return
    rightmost = min(end, machine.last_column) // machine.pixels
    for number in range(begin // machine.pixels, rightmost + 1):
        bank = bank_of(line, number, machine)
        slot = number - outermost
        window.left[bank] |= 1 << slot
        window.address[bank, slot] = _address(line, number, machine)
        if machine.planes > 1:
            left = machine.pixels * number
            first, last = max(begin - left, 0), min(end - left, machine.pixels - 1)
            window.covered[bank, slot] = (2 << last) - (1 << first)
            window.place[bank, slot] = _start(line, number, machine)


@nb.njit(cache=True, inline="always")
def _address(line: int, number: int, machine: Machine) -> int:
    """Return where a bank has a word of a line: any number of its own will do."""
    return line % LINES // machine.half_banks * machine.half_words + number // 2


@nb.njit(cache=True)
def _deal(window: Window, offered: bool) -> bool:
    """Deal each bank the leftmost word that it has left, if an element is offered, or none.

    Return whether no bank has any left.
    """
    last = offered
    for bank in range(len(window.left)):
        left = window.left[bank] if offered else 0
        if left == 0:
            window.dealt[bank] = EMPTY
            continue
        slot = 0 if left & 1 else 1 if left & 2 else 2
        window.dealt[bank] = window.address[bank, slot]
        window.dealt_covered[bank] = window.covered[bank, slot]
        window.dealt_place[bank] = window.place[bank, slot]
        left &= left - 1
        window.left[bank] = left
        last = last and left == 0
    return last


@nb.njit(cache=True)
def _draw(window: Window, go: bool, held: int, z: int, machine: Machine) -> bool:
    """Let each bank take the word that it was dealt, but for those that are ``held``.

    Return whether all are taken.
    """
    done = go
    for bank in range(len(window.left)):
        address = window.dealt[bank]
        if not go or address == EMPTY:
            window.taken[bank] = EMPTY
            continue
        conflict = machine.hazard and window.taken[bank] == address
        if conflict or held >> bank & 1 or window.reading[0, bank] == 1:
            window.taken[bank] = EMPTY
            done = False
            continue
        window.taken[bank] = address
        window.dealt[bank] = EMPTY
        _mark(window, bank, address, machine)
        if machine.planes > 1 and _passes(window, bank, z, machine):
            window.reading[2, bank] = 1
    return done


@nb.njit(cache=True)
def _mark(window: Window, bank: int, address: int, machine: Machine) -> None:
    """Mark the words that share a mark with the one at an address of a bank."""
    group, number = divmod(address, machine.half_words)
    first = number - number % machine.mark_words
    place = machine.half_banks * group + bank % machine.half_banks
    odd = int(bank != bank_of(place, 0, machine))
    for shared in range(first, min(first + machine.mark_words, machine.half_words)):
        window.marks[place, 2 * shared + odd] = True


@nb.njit(cache=True)
def _passes(window: Window, bank: int, z: int, machine: Machine) -> bool:
    """Draw the pixels of a word that pass the depth test; return whether any did."""
    passed = False
    start = window.dealt_place[bank]
    for pixel in range(machine.pixels):
        if window.dealt_covered[bank] >> pixel & 1 and z < window.depth[start + pixel]:
            window.depth[start + pixel] = z
            passed = True
    return passed


@nb.njit(cache=True)
def _drawn(window: Window, machine: Machine) -> int:
    """Return the places of the lines that the banks took a word of in the cycle before."""
    places = 0
    for bank in range(len(window.left)):
        if window.taken[bank] != EMPTY:
            group = window.taken[bank] // machine.half_words
            places |= 1 << (machine.half_banks * group + bank % machine.half_banks)
    return places


@nb.njit(cache=True)
def _give_up(window: Window, machine: Machine) -> int:
    """Return whether the word that leaves is ``BLANK``, and keep its bank for its planes if not."""
    if machine.planes == 1:
        return BLANK
    line, number = window.walk[OLDEST], window.walk[ASKED]
    if machine.pixels * number > machine.last_column:  # it shares its mark with one of the image
        return BLANK
    start = _start(line, number, machine)
    kind, shown = BLANK, False
    for pixel in range(machine.pixels):
        if window.depth[start + pixel] != machine.z_mask:
            shown = True
            if machine.pixels * number + pixel <= machine.last_column:
                kind = SHOWN
    # The bank does not know where the image ends; the way out does. Stored behind the loop: within
    # it LLVM 22 vectorizes the store for CPUs with AVX-512, and wrongly (docs/decisions.md).
    if shown:
        window.reading[2, bank_of(line, number, machine)] = 1
    return kind


@nb.njit(cache=True)
def _shift(window: Window, leaves: int) -> None:
    """Let a cycle pass for what is on its way: planes to read, and words that leave."""
    window.reading[0] = window.reading[1]
    window.reading[1] = window.reading[2]
    window.reading[2] = 0
    window.leaving[2] = window.leaving[1]
    window.leaving[1] = window.leaving[0]
    window.leaving[0] = leaves


@nb.njit(cache=True)
def _on_the_way(window: Window, machine: Machine) -> bool:
    """Return whether a flushed word is between its bank and the port."""
    further = window.leaving[2] if machine.planes > 1 else 0
    return window.leaving[0] + window.leaving[1] + further != 0


@nb.njit(cache=True, inline="always")
def _start(line: int, number: int, machine: Machine) -> int:
    """Return where a word of a line starts in ``depth``."""
    return machine.pixels * (line * (machine.last_column // machine.pixels + 1) + number)


@nb.njit(cache=True)
def _pixels(machine: Machine) -> int:
    """Return how many pixels the image's words have; none are needed for one plane."""
    return _start(machine.last_line + 1, 0, machine) if machine.planes > 1 else 0
