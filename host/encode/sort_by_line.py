"""Sorting code words by line, in linear time, with the control words between."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.host.compiled_cache import cached_njit

from .encode import Encoded
from .shape_table import EMPTY_SCANS
from .stand_ins import X_LSB, number_of, replace, stand_in

__all__ = ["PERIOD", "advance_word", "end_word", "sort_by_line"]


GROUP_BITS = 3

GROUP = 1 << GROUP_BITS
"""Columns of a group: those of a block, so that words of the groups 0, 2, 4 and so on share no
pixel if their groups differ."""

PERIOD = 2 * GROUP
"""Columns after which the order repeats."""

FEW = 16
"""Words up to which one insertion sorts them."""


def advance_word(lines: int, config: EngineConfig) -> int:
    """Return the control word that advances the engine's line; of a plane word its low half."""
    return _control(config) | lines << config.x.lsb


def end_word(config: EngineConfig) -> int:
    """Return the control word that ends a frame; of a plane word its low half."""
    return _control(config) | 1 << config.control_end.lsb


def sort_by_line(encoded: Encoded, config: EngineConfig) -> tuple[npt.NDArray[np.uint64], int]:
    """Return a frame's stream: the words by line, control words between, the end word last.

    It is a counting sort in parallel: each chunk of words knows how many of each line come before
    it. Each line with words costs one control word, unless the gap before it is more than X holds.

    An element costs the engine a cycle if it follows another into the same memory word. A line's
    words are therefore taken from groups of eight columns in turn, of each group as evenly as its
    number of words allows, left to right: first from the groups 0, 2, 4 and so on, then from the
    others. Words of one column come in ascending order, the nearest first.

    **The order of two words that share a pixel depends on these two alone.** Such words are at most
    eight columns apart, so they lie in one group or in neighbouring groups. So of equal depths the
    same word stays, whatever else is drawn, and wherever the image begins, as long as its lines and
    columns are moved by multiples of ``PERIOD`` (decision 0015). Compact words are wider.

    Parameters
    ----------
    encoded
        Code words of elements.
    config
        Where the fields are.

    Returns
    -------
    stream
        Shape (n + control words,), uint64; of an engine with planes (n + control words, 2).
    control_words
        How many of them there are.
    """
    element_words, x_lsb = encoded.words, config.x.lsb
    if config.plane:
        element_words, x_lsb = stand_in(encoded.words, config), X_LSB
    before = np.cumsum(encoded.counts, axis=0, dtype=np.int64)
    counts = before[-1].copy()
    before -= encoded.counts
    used = np.flatnonzero(counts)
    gaps = np.diff(used, prepend=0)
    steps = -(-gaps // config.x.mask)  # control words before each used line
    ends = np.cumsum(counts[used] + steps)
    starts = np.zeros(len(counts), np.int64)
    starts[used] = ends - counts[used]
    total = int(ends[-1]) if len(used) else 0
    stream = np.empty(total + 1, np.uint64)
    _write_controls(stream, starts[used], gaps, steps, config)
    words, ordered = np.empty(total, np.uint64), np.empty(total, np.uint64)
    positions = np.cumsum(counts) - counts  # of each line's words without control words
    before += positions
    lookup = encoded.words if config.plane else np.empty((0, 2), np.uint64)
    plane = lookup, config.plane
    chunks = encoded.lines, encoded.starts, encoded.stops, before
    _by_line(element_words, chunks, words)
    _by_column(words, ordered, positions, counts, starts, (x_lsb, config.x.mask), plane, stream)
    stream[-1] = end_word(config)
    if config.plane:
        stream = replace(stream, encoded.words)
    return stream, int(steps.sum()) + 1


def _control(config: EngineConfig) -> int:
    return 1 << config.mode.lsb | EMPTY_SCANS << config.scans.lsb


def _write_controls(
    stream: npt.NDArray[np.uint64],
    starts: npt.NDArray[np.int64],
    gaps: npt.NDArray[np.int64],
    steps: npt.NDArray[np.int64],
    config: EngineConfig,
) -> None:
    """Write the control words before each used line, the remainder of a long gap first."""
    furthest = config.x.mask
    longest = int(steps.max(initial=0))
    for back in range(1, longest + 1):  # once, unless a gap is beyond what X holds
        here = steps >= back
        step = np.minimum(gaps[here] - (back - 1) * furthest, furthest)
        stream[starts[here] - back] = advance_word(0, config) | step.astype(np.uint64) << np.uint64(
            config.x.lsb
        )


@nb.njit(inline="always")
def _value(word: int, plane: Any) -> Any:
    """Return what words of one column are sorted by: first their highest 64 bits, then the others.

    Parameters
    ----------
    word
        The word or stand-in.
    plane
        Plane words by their number, and whether the words stand for them.
    """
    lookup, is_plane = plane
    if not is_plane:
        return word, np.uint64(0)
    low, high = lookup[number_of(word), 0], lookup[number_of(word), 1]
    return high << np.uint64(32) | low >> np.uint64(32), low


@cached_njit(parallel=True)
def _by_line(words: Any, chunks: Any, sorted_words: Any) -> None:
    """Bring the words of each line together; each chunk knows where its own go."""
    lines, begins, ends, before = chunks
    for chunk in nb.prange(len(begins)):
        positions = before[chunk]
        for i in range(begins[chunk], ends[chunk]):
            position = positions[lines[i]]
            positions[lines[i]] = position + 1
            sorted_words[position] = words[i]


@cached_njit(parallel=True)
def _by_column(
    words: Any,
    ordered: Any,
    positions: Any,
    counts: Any,
    starts: Any,
    x: tuple[int, int],
    plane: Any,
    stream: Any,
) -> None:
    """Put each line's words into the stream, from its groups of columns in turn.

    Parameters
    ----------
    words
        The words of each line together.
    ordered
        Overwritten: shape of ``words``.
    positions, counts, starts
        Of each line: its words in ``words``, their number, and where they go in ``stream``.
    x
        Lowest bit and mask of X.
    plane
        See :func:`_value`.
    """
    lsb, mask = np.uint64(x[0]), np.uint64(x[1])
    half = (x[1] + 1) // 2
    for line in nb.prange(len(counts)):
        if counts[line]:
            begin, end = positions[line], positions[line] + counts[line]
            following = np.zeros(2 * half + 1, np.int64)
            for i in range(begin, end):
                following[_place(words[i] >> lsb & mask, half) + 1] += 1
            following[0] = begin
            for place in range(2 * half):
                following[place + 1] += following[place]
            for i in range(begin, end):
                place = _place(words[i] >> lsb & mask, half)
                ordered[following[place]] = words[i]
                following[place] += 1
            # Now ``following`` has where the words of each place end.
            first = begin
            for place in range(2 * half):
                last = following[place]
                if last > first + 1:
                    _ascending(ordered, first, last, plane)
                first = last
            to = starts[line]
            middle = following[half - 1]
            _in_turn(ordered, begin, middle, following[:half], stream, to)
            _in_turn(ordered, middle, end, following[half:-1], stream, to + middle - begin)


@nb.njit(inline="always")
def _place(column: Any, half: int) -> Any:
    """Return a column's place if the groups 0, 2, 4 and so on come first, then the others."""
    number = np.int64(column)
    within = number >> GROUP_BITS + 1 << GROUP_BITS | number & GROUP - 1
    return within + half * (number >> GROUP_BITS & 1)


@nb.njit
def _ascending(words: Any, first: int, last: int, plane: Any) -> None:
    """Sort words of one column: insertion over ever smaller gaps (Shell, 1959, with Knuth's gaps).

    Numba takes seconds to compile a sort of numpy's.
    """
    gap = 1
    while FEW * gap < last - first:
        gap = 3 * gap + 1
    while gap:
        for i in range(first + gap, last):
            word = words[i]
            own = _value(word, plane)
            at = i
            while at >= first + gap and own < _value(words[at - gap], plane):
                words[at] = words[at - gap]
                at -= gap
            words[at] = word
        gap //= 3


@nb.njit
def _in_turn(words: Any, begin: int, end: int, ends: Any, stream: Any, to: int) -> None:
    """Put words into the stream, those of each group evenly over all of them.

    The word of rank r among n of its group goes to the share (r + 1/2) / n of the way.

    Parameters
    ----------
    words
        Those from ``begin`` to ``end`` are sorted by group.
    ends
        Where the words of each column end.
    stream, to
        They go from here on.
    """
    count = end - begin
    following = np.zeros(count + 1, np.int64)
    for turn in range(2):
        first = begin
        for group in range(len(ends) >> GROUP_BITS):
            last = ends[(group + 1 << GROUP_BITS) - 1]
            share = count / (2.0 * (last - first)) if last > first else 0.0
            for i in range(first, last):
                step = int((2 * (i - first) + 1) * share)
                if turn == 0:
                    following[step + 1] += 1
                else:
                    stream[to + following[step]] = words[i]
                    following[step] += 1
            first = last
        if turn == 0:
            for step in range(count):
                following[step + 1] += following[step]
