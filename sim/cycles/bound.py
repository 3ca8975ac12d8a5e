"""The fewest cycles that the window's memory allows for a frame.

A memory word is one pixel. A lane reads one pixel and writes one pixel a cycle. An element
therefore takes at least as many cycles as its busiest lane has pixels.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import decode_plane_word, decode_word
from splatline.contract.config import BLOCK
from splatline.contract.fields import Field
from splatline.contract.frame import Frame, are_control
from splatline.host.compiled_cache import cached_njit
from splatline.sim.golden.compact_words import expand_frame
from splatline.sim.golden.renderer import render

from .front import ABOVE, halves_of
from .tiles import least_lane_cycles

__all__ = ["bound_cycles"]

_Ints = npt.NDArray[np.int64]


class _Elements(NamedTuple):
    """The elements of a frame up to its end word.

    Parameters
    ----------
    words, highs
        Their code words, from :func:`splatline.sim.cycles.front.halves_of`.
    x
        Image column of the block's column 0: shape (n,).
    top
        Line of the block's row 0: shape (n,).
    first, last
        Columns of each row, from :func:`_rows`: shape (n, 8).
    """

    words: _Ints
    highs: _Ints
    x: _Ints
    top: _Ints
    first: _Ints
    last: _Ints


def bound_cycles(frame: Frame) -> int:
    """Return the fewest cycles that the layout of the window's memory allows for a frame.

    It is the larger of two bounds. Throughput of the lanes: one pixel a lane and cycle, for all
    pixels that are drawn or flushed, spread evenly. Height of the window: each element takes as
    many cycles as its busiest lane has pixels, and one beat is flushed a cycle (see
    :func:`_slide`). Elements are not clipped: tiles outside the image take cycles too.
    """
    config = frame.config
    elements = _elements(expand_frame(frame))
    if config.draws_blocks:
        # A block uses each lane at most once, wherever it lies.
        costs = np.ones(len(elements.words), np.int64)
        memories = BLOCK * config.raster_pixels
    else:
        costs = least_lane_cycles(elements.words, elements.highs, config.pixels_per_word)
        memories = 4 * config.pixels_per_word
    drawn = render(frame).drawn
    leaving = int(_groups(drawn, config.pixels_per_word).sum())
    beats = _groups(drawn, config.raster_pixels)
    upper, lower = _lines(elements, frame)
    slid = _slide(upper, lower, costs, beats, config.window_lines)
    # The odd word of a pair is flushed through the other port.
    leaving = -(-leaving // config.flush_words)
    covered = int(np.maximum(elements.last - elements.first + 1, 0).sum())
    pixels = covered + config.pixels_per_word * leaving
    return max(slid, -(-pixels // memories))


@cached_njit()
def _slide(upper: Any, lower: Any, costs: Any, beats: Any, lines: int) -> int:
    """Return the cycles in which elements pass through a window that slides down the image.

    A line leaves, beat by beat, once it is complete and the lines above it have left. An element
    is drawn into a line once the line that had its slot has left. Elements are drawn in order.
    Latency, control words and conflicts for lanes are not counted.

    Parameters
    ----------
    upper, lower
        The first and last line that each element draws into, ``upper > lower`` if none: shape (n,),
        int64.
    costs
        Cycles of each element: shape (n,), int64.
    beats
        Dirty beats of each line: shape (height,), int64.
    lines
        Lines of the window.
    """
    drawn = np.zeros(len(beats), np.int64)  # cycle of each line's last element
    now = left = leaving = 0  # this cycle; that in which the line above ``leaving`` left
    for i in range(len(costs)):
        while leaving <= lower[i] - lines:
            left = max(left, drawn[leaving]) + beats[leaving]
            leaving += 1
        now = max(now + costs[i], left + 1)
        drawn[upper[i] : lower[i] + 1] = now
    for line in range(leaving, len(beats)):
        left = max(left, drawn[line]) + beats[line]
    return max(now, left)


def _elements(frame: Frame) -> _Elements:
    """Return the elements of a frame without compact words."""
    config = frame.config
    words, highs = halves_of(frame.codewords, config)
    control = are_control(words.view(np.uint64), config)
    ends = control & (_take(words, config.control_end) == 1)
    x = _take(words, config.x)
    line = np.cumsum(np.where(control, x, 0))
    at = np.flatnonzero(~control & (np.cumsum(ends) == 0))
    words, highs = words[at], highs[at] if config.plane else highs
    rows = _rows(words, highs)
    return _Elements(words, highs, x[at], line[at] - ABOVE, rows[..., 0], rows[..., 1])


def _take(words: _Ints, field: Field) -> _Ints:
    """Return the value of a field in each code word."""
    return words >> field.lsb & field.mask


@cached_njit()
def _rows(words: Any, highs: Any) -> Any:
    """Return first and last column of each row of each element's block: shape (n, 8, 2), int64.

    An empty row has first > last.
    """
    rows = np.empty((len(words), BLOCK, 2), np.int64)
    for i in range(len(words)):
        if len(highs):
            decode_plane_word(words[i], highs[i], rows[i])
        else:
            decode_word(words[i], rows[i])
    return rows


def _lines(elements: _Elements, frame: Frame) -> tuple[_Ints, _Ints]:
    """Return the first and last line of the image that each element draws into."""
    first, last = elements.first, elements.last
    inside = elements.x[:, np.newaxis] + first < frame.width
    lines = elements.top[:, np.newaxis] + np.arange(BLOCK)
    fills = (first <= last) & inside & (lines >= 0) & (lines < frame.height)
    upper = np.where(fills, lines, frame.height).min(axis=1, initial=frame.height)
    return upper, np.where(fills, lines, -1).max(axis=1, initial=-1)


def _groups(drawn: npt.NDArray[np.bool_], pixels: int) -> _Ints:
    """Return for each line how many groups of neighbouring pixels have a drawn one."""
    starts = range(0, drawn.shape[1], pixels)
    return np.count_nonzero(np.add.reduceat(drawn, starts, axis=1), axis=1).astype(np.int64)
