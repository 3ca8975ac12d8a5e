"""Sorting code words by line, in linear time, with the control words between."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..rtl.format import EngineConfig
from .encode import Encoded
from .shapes import EMPTY_SCANS

__all__ = ["advance_word", "end_word", "sort_by_line"]


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

    The two halves of a line's words are dealt out in turn. Neighbours in a cloud tend to be
    neighbours on the image, and an element that follows another into the same word of the engine's
    memory costs it a cycle; half a line apart they hardly ever meet.

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
    for line, gap in zip(used, gaps, strict=True):  # once a line of the image
        at = int(starts[line])
        while gap > 0:
            at -= 1
            step = min(int(gap), config.x.mask)
            stream[at] = advance_word(step, config)
            gap -= step
    chunks = (encoded.words, encoded.lines, encoded.starts, encoded.stops)
    _scatter(chunks, before, counts, starts, stream)
    stream[-1] = end_word(config)
    return stream, int(steps.sum()) + 1


def _control(config: EngineConfig) -> int:
    return 1 << config.mode.lsb | EMPTY_SCANS << config.scans.lsb


@nb.njit(parallel=True, cache=True)
def _scatter(chunks: Any, before: Any, counts: Any, starts: Any, stream: Any) -> None:
    """Put each word at its place: of a line's words, the first half on even places."""
    words, lines, begins, ends = chunks
    for chunk in nb.prange(len(begins)):
        placed = before[chunk]
        for i in range(begins[chunk], ends[chunk]):
            line = lines[i]
            number = placed[line]
            placed[line] += 1
            half = (counts[line] + 1) // 2
            place = 2 * number if number < half else 2 * (number - half) + 1
            stream[starts[line] + place] = words[i]
