"""Sorting code words by line, in linear time, with the control words between."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .encode import Encoded
from .shape_table import EMPTY_SCANS

__all__ = ["advance_word", "end_word", "in_turn", "sort_by_line"]


TURNS = 256
"""Values that a turn has."""

STRIPS = 4
"""Parts of a line that its words come from in turn."""


def advance_word(lines: int, config: EngineConfig) -> int:
    """Return the control word that advances the engine's line."""
    return _control(config) | lines << config.x.lsb


def end_word(config: EngineConfig) -> int:
    """Return the control word that ends a frame."""
    return _control(config) | 1 << config.control_end.lsb


def sort_by_line(encoded: Encoded, config: EngineConfig) -> tuple[npt.NDArray[np.uint64], int]:
    """Return a frame's stream: the words by line, control words between, the end word last.

    A counting sort, in parallel: each chunk of words knows how many of each line come before it.
    Consecutive lines with words cost one control word, whatever lies between them, unless the gap
    is beyond what X holds.

    An element that follows another into the same word of the engine's memory costs it a cycle, and
    with further colour planes one that follows it but one. So a line's words are sorted by their
    columns, cut into four strips, and come from these in turn: two that follow each other are a
    quarter of the line's words apart. Words of one column come by their turns, and of one turn in
    their order.

    Parameters
    ----------
    encoded
        Code words of elements.
    config
        Where the fields are.

    Returns
    -------
    stream
        Shape (n + control words,), uint64.
    control_words
        How many of them there are.
    """
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
    words, turns = np.empty(total, np.uint64), np.empty(total, np.uint8)
    turned = np.empty(total, np.uint64)
    places = np.cumsum(counts) - counts  # of each line's words without control words
    before += places
    _by_line(
        encoded.words,
        encoded.lines,
        encoded.turns,
        encoded.starts,
        encoded.stops,
        before,
        words,
        turns,
    )
    _by_turn(words, turns, places, counts, turned)
    _by_column(turned, places, counts, starts, (config.x.lsb, config.x.mask), stream)
    stream[-1] = end_word(config)
    return stream, int(steps.sum()) + 1


@nb.njit(inline="always")
def in_turn(rank: int, count: int, strips: int) -> int:
    """Return the turn of the word with a rank among ``count``, if strips of them take turns.

    The first strips have a word more, if the words do not go into them evenly.
    """
    shortest, longer = divmod(count, strips)
    head = longer * (shortest + 1)  # words of the strips that have one more
    if rank < head:
        strip, place = divmod(rank, shortest + 1)
    else:
        strip, place = divmod(rank - head, shortest)
        strip += longer
    return strips * place + strip


def _control(config: EngineConfig) -> int:
    return 1 << config.mode.lsb | EMPTY_SCANS << config.scans.lsb


def _write_controls(
    stream: npt.NDArray[np.uint64],
    starts: npt.NDArray[np.int64],
    gaps: npt.NDArray[np.int64],
    steps: npt.NDArray[np.int64],
    config: EngineConfig,
) -> None:
    """Write the control words before each used line: the largest steps, and what is left first."""
    furthest = config.x.mask
    longest = int(steps.max(initial=0))
    for back in range(1, longest + 1):  # once, unless a gap is beyond what X holds
        here = steps >= back
        step = np.minimum(gaps[here] - (back - 1) * furthest, furthest)
        stream[starts[here] - back] = advance_word(0, config) | step.astype(np.uint64) << np.uint64(
            config.x.lsb
        )


@nb.njit(parallel=True, cache=True)
def _by_line(
    words: Any,
    lines: Any,
    turns: Any,
    begins: Any,
    ends: Any,
    before: Any,
    sorted_words: Any,
    sorted_turns: Any,
) -> None:
    """Bring the words of each line together; each chunk knows the places of its own."""
    for chunk in nb.prange(len(begins)):
        places = before[chunk]
        for i in range(begins[chunk], ends[chunk]):
            place = places[lines[i]]
            places[lines[i]] = place + 1
            sorted_words[place] = words[i]
            sorted_turns[place] = turns[i]


@nb.njit(parallel=True, cache=True)
def _by_turn(words: Any, turns: Any, places: Any, counts: Any, turned: Any) -> None:
    """Sort each line's words by their turns."""
    for line in nb.prange(len(counts)):
        if counts[line]:
            begin, end = places[line], places[line] + counts[line]
            following = np.zeros(TURNS + 1, np.int64)
            for i in range(begin, end):
                following[turns[i] + 1] += 1
            following[0] = begin
            for turn in range(TURNS):
                following[turn + 1] += following[turn]
            for i in range(begin, end):
                turned[following[turns[i]]] = words[i]
                following[turns[i]] += 1


@nb.njit(parallel=True, cache=True)
def _by_column(
    turned: Any, places: Any, counts: Any, starts: Any, x: tuple[int, int], stream: Any
) -> None:
    """Sort each line's words by X, and put them into the stream from the strips in turn."""
    lsb, mask = np.uint64(x[0]), np.uint64(x[1])
    for line in nb.prange(len(counts)):
        if counts[line]:
            begin, end = places[line], places[line] + counts[line]
            following = np.zeros(x[1] + 2, np.int64)
            for i in range(begin, end):
                following[(turned[i] >> lsb & mask) + np.uint64(1)] += 1
            for column in range(x[1] + 1):
                following[column + 1] += following[column]
            for i in range(begin, end):
                column = turned[i] >> lsb & mask
                rank = following[column]
                following[column] += 1
                stream[starts[line] + in_turn(rank, counts[line], STRIPS)] = turned[i]
