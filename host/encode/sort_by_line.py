"""Sorting code words by line, in linear time, with the control words between."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig

from .encode import Encoded
from .shape_table import EMPTY_SCANS
from .stand_ins import X_LSB, replace, stand_in

__all__ = ["advance_word", "end_word", "interleaved", "sort_by_line"]


KEYS = 256
"""Values of a sort key."""

STRIPS = 4
"""Strips of columns of a line; its words come from them alternately."""


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
    words are therefore sorted by column and cut into four strips, which alternate: two consecutive
    words are a quarter of the line's words apart. Words of one column are sorted by key, and words
    of one key keep their order.

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
    words, keys = np.empty(total, np.uint64), np.empty(total, np.uint8)
    by_key = np.empty(total, np.uint64)
    positions = np.cumsum(counts) - counts  # of each line's words without control words
    before += positions
    _by_line(
        element_words,
        encoded.lines,
        encoded.keys,
        encoded.starts,
        encoded.stops,
        before,
        words,
        keys,
    )
    _by_key(words, keys, positions, counts, by_key)
    _by_column(by_key, positions, counts, starts, (x_lsb, config.x.mask), stream)
    stream[-1] = end_word(config)
    if config.plane:
        stream = replace(stream, encoded.words)
    return stream, int(steps.sum()) + 1


@nb.njit(inline="always")
def interleaved(rank: int, count: int, strips: int) -> int:
    """Return where the word with a rank among ``count`` goes if strips of them alternate.

    The first strips have one word more if the count is no multiple of the strips.
    """
    shortest, longer = divmod(count, strips)
    head = longer * (shortest + 1)  # words of the strips that have one more
    if rank < head:
        strip, position = divmod(rank, shortest + 1)
    else:
        strip, position = divmod(rank - head, shortest)
        strip += longer
    return strips * position + strip


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


@nb.njit(parallel=True, cache=True)
def _by_line(
    words: Any,
    lines: Any,
    keys: Any,
    begins: Any,
    ends: Any,
    before: Any,
    sorted_words: Any,
    sorted_keys: Any,
) -> None:
    """Bring the words of each line together; each chunk knows where its own go."""
    for chunk in nb.prange(len(begins)):
        positions = before[chunk]
        for i in range(begins[chunk], ends[chunk]):
            position = positions[lines[i]]
            positions[lines[i]] = position + 1
            sorted_words[position] = words[i]
            sorted_keys[position] = keys[i]


@nb.njit(parallel=True, cache=True)
def _by_key(words: Any, keys: Any, positions: Any, counts: Any, by_key: Any) -> None:
    """Sort each line's words by their keys."""
    for line in nb.prange(len(counts)):
        if counts[line]:
            begin, end = positions[line], positions[line] + counts[line]
            following = np.zeros(KEYS + 1, np.int64)
            for i in range(begin, end):
                following[keys[i] + 1] += 1
            following[0] = begin
            for key in range(KEYS):
                following[key + 1] += following[key]
            for i in range(begin, end):
                by_key[following[keys[i]]] = words[i]
                following[keys[i]] += 1


@nb.njit(parallel=True, cache=True)
def _by_column(
    by_key: Any, positions: Any, counts: Any, starts: Any, x: tuple[int, int], stream: Any
) -> None:
    """Sort each line's words by X, and put them into the stream from the strips alternately."""
    lsb, mask = np.uint64(x[0]), np.uint64(x[1])
    for line in nb.prange(len(counts)):
        if counts[line]:
            begin, end = positions[line], positions[line] + counts[line]
            following = np.zeros(x[1] + 2, np.int64)
            for i in range(begin, end):
                following[(by_key[i] >> lsb & mask) + np.uint64(1)] += 1
            for column in range(x[1] + 1):
                following[column + 1] += following[column]
            for i in range(begin, end):
                column = by_key[i] >> lsb & mask
                rank = following[column]
                following[column] += 1
                stream[starts[line] + interleaved(rank, counts[line], STRIPS)] = by_key[i]
