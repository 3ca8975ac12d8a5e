"""How few cycles a frame could take, by how the window's memory is laid out.

A memory word holds neighbouring pixels; a bank reads one word and writes one word a cycle. No
order of work draws an element in fewer cycles than its busiest bank has words of it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from ..host.frame import Frame
from ..rtl.format import BLOCK, ROWS, EngineConfig
from ..rtl.presets import PAPER
from .expand import expand_frame
from .golden import block_rows, decode, render
from .lane_model import least_lane_cycles
from .stress_words import elements_of

__all__ = ["LAYOUTS", "bound_cycles", "least_cycles"]

_Ints = npt.NDArray[np.int64]

LAYOUTS = {
    "whole columns": "bank = line mod 8; all lines take the same column of words at a time",
    "lines apart": "bank = line mod 8; each line takes the words that its row touches",
    "interleaved": "bank = (line + 4 (word mod 2)) mod 8, as an engine of eight banks has it",
    "sixteen": "bank = line mod 8 + 8 (word mod 2), as an engine of sixteen has it",
}
"""The layouts compared. Words of four pixels have the same sixteen block RAMs in the first three,
and twice as many in the last, which is that of words of eight as well: those have twice as many
again."""


def bound_cycles(frame: Frame) -> int:
    """Return the least cycles that the layout of the engine's memory leaves for a frame.

    The larger of two. A bank, or lane, takes one word, or pixel, in a cycle: all that are drawn and
    all that leave, were they spread evenly. And each element takes as many cycles as its busiest
    bank has words, or its busiest lane pixels, one beat of the raster leaves in a cycle, and the
    window has only so many lines: see :func:`_slide`. What lanes take of an element is
    as if nothing of it were clipped: tiles outside the image take their cycles too.
    """
    config = frame.config
    frame = _until_the_end(expand_frame(frame))
    fields, line, places = elements_of(frame)
    if config.rows_of_lanes:
        # Wherever a block lies, it has each lane once at most.
        costs = np.ones(len(places), np.int64)
        memories, of_a_word = BLOCK * config.raster_pixels, config.pixels_per_word
        accesses = _covered_pixels(fields)
    elif config.lanes:
        costs = least_lane_cycles(frame.codewords[places].view(np.int64), config.pixels_per_word)
        memories, of_a_word = 4 * config.pixels_per_word, config.pixels_per_word
        accesses = _covered_pixels(fields)
    else:
        touched = _touched_words(fields, config.pixels_per_word)
        touched &= _words_inside(fields, line, frame)
        costs = _costs(touched)[_layout(config)]
        memories, of_a_word = config.banks, 1
        accesses = int(touched.sum())
    drawn = render(frame).drawn
    leaving = int(_groups(drawn, config.pixels_per_word).sum())
    beats = _groups(drawn, config.raster_pixels)
    upper, lower = _lines(fields, line, frame)
    slid = _slide(upper, lower, costs, beats, config.window_lines)
    return max(slid, -(-(accesses + of_a_word * leaving) // memories))


def least_cycles(frame: Frame) -> dict[str, float]:
    """Return the mean least cycles of an element, for each of ``LAYOUTS`` and words of four pixels.

    Clipping is left out: a word that lies outside the image counts as one inside.
    """
    fields, _, _ = elements_of(_until_the_end(expand_frame(frame)))
    costs = _costs(_touched_words(fields, PAPER.pixels_per_word))
    return {name: float(taken.mean()) for name, taken in costs.items()}


@nb.njit(cache=True)
def _slide(upper: Any, lower: Any, costs: Any, beats: Any, lines: int) -> int:
    """Return the cycles in which elements pass through a window that slides down the image.

    A line leaves, beat by beat, once nothing more is drawn into it and those above have left. No
    element is drawn into a line before the one whose place it takes has left. Elements are drawn in
    their order; the engine's own time is not counted, nor control words, nor who waits for whom at
    a bank.

    Parameters
    ----------
    upper, lower
        The first and last line that each element draws into, ``upper > lower`` if none: shape (n,),
        int64.
    costs
        The cycles that each takes: shape (n,), int64.
    beats
        Those of each line: shape (height,), int64.
    lines
        Of the window.
    """
    drawn = np.zeros(len(beats), np.int64)  # when the last element of each line was
    now = left = leaving = 0  # cycles passed; when the line above ``leaving`` had left
    for i in range(len(costs)):
        while leaving <= lower[i] - lines:
            left = max(left, drawn[leaving]) + beats[leaving]
            leaving += 1
        now = max(now + costs[i], left + 1)
        drawn[upper[i] : lower[i] + 1] = now
    for line in range(leaving, len(beats)):
        left = max(left, drawn[line]) + beats[line]
    return max(now, left)


def _until_the_end(frame: Frame) -> Frame:
    """Return the frame without the words behind its end word."""
    (ends,) = np.nonzero(decode(frame.codewords, frame.config)["end"])
    return replace(frame, codewords=frame.codewords[: ends[0] + 1]) if len(ends) else frame


def _layout(config: EngineConfig) -> str:
    return "interleaved" if config.banks == 8 else "sixteen"


def _lines(fields: npt.NDArray[Any], line: _Ints, frame: Frame) -> tuple[_Ints, _Ints]:
    """Return the first and last line of the image that each element draws into."""
    first, last = block_rows(fields)
    inside = fields["x"].astype(np.int64)[:, np.newaxis] + first < frame.width
    lines = (line - BLOCK // 2)[:, np.newaxis] + np.arange(BLOCK)
    fills = (first <= last) & inside & (lines >= 0) & (lines < frame.height)
    upper = np.where(fills, lines, frame.height).min(axis=1, initial=frame.height)
    return upper, np.where(fills, lines, -1).max(axis=1, initial=-1)


def _costs(touched: npt.NDArray[np.bool_]) -> dict[str, _Ints]:
    """Return the least cycles of each element, for each of ``LAYOUTS``."""
    columns = touched.any(axis=1).sum(axis=1)
    rows = touched.sum(axis=2).max(axis=1)
    words = touched.astype(np.int64)
    upper, lower = words[:, :ROWS], words[:, ROWS:]
    # Of three neighbouring words a bank holds the outer two of one line and the middle one of the
    # line four above or below.
    outer_upper = upper[..., 0] + upper[..., 2] + lower[..., 1]
    outer_lower = lower[..., 0] + lower[..., 2] + upper[..., 1]
    banks = np.maximum(outer_upper, outer_lower).max(axis=1)
    # Of sixteen: the outer two or the middle one; of words of eight, one of two.
    lines = np.maximum(words[..., 0] + words[..., 2], words[..., 1]).max(axis=1)
    cycles = dict(zip(LAYOUTS, (columns, rows, banks, lines), strict=True))
    return {name: np.maximum(taken, 1) for name, taken in cycles.items()}


def _groups(drawn: npt.NDArray[np.bool_], pixels: int) -> _Ints:
    """Return in how many groups of so many neighbouring pixels each line has something."""
    starts = range(0, drawn.shape[1], pixels)
    return np.count_nonzero(np.add.reduceat(drawn, starts, axis=1), axis=1).astype(np.int64)


def _covered_pixels(fields: npt.NDArray[np.void]) -> int:
    """Return how many pixels elements cover, each for itself."""
    first, last = block_rows(fields)
    return int(np.maximum(last - first + 1, 0).sum())


def _words_inside(fields: npt.NDArray[Any], line: _Ints, frame: Frame) -> npt.NDArray[np.bool_]:
    """Return which of the three words of ``_touched_words`` lie in the image.

    The others are never dealt.
    """
    lines = (line - BLOCK // 2)[:, np.newaxis] + np.arange(BLOCK)
    pixels = frame.config.pixels_per_word
    words = (fields["x"].astype(np.int64) // pixels)[:, np.newaxis] + np.arange(3)
    across = words <= (frame.width - 1) // pixels
    return ((lines >= 0) & (lines < frame.height))[..., np.newaxis] & across[:, np.newaxis]


def _touched_words(fields: npt.NDArray[Any], pixels: int) -> npt.NDArray[np.bool_]:
    """Return which of three neighbouring words each row touches: shape (elements, 8, 3).

    Parameters
    ----------
    fields
        The elements, as ``decode`` returns them.
    pixels
        Of a word. With words of eight the third is never touched.
    """
    first, last = block_rows(fields)
    offset = (fields["x"].astype(np.int64) % pixels)[:, np.newaxis]
    begin, end = (first + offset) // pixels, (last + offset) // pixels
    word = np.arange(3)
    inside = (begin[..., np.newaxis] <= word) & (word <= end[..., np.newaxis])
    return inside & (first <= last)[..., np.newaxis]
