"""How many cycles a frame takes, and how few its code words could take.

``count_cycles`` is exact: what the Verilog would count, without running it. ``least_cycles`` is a
bound by how the window's memory is laid out. A memory word holds four neighbouring pixels; a bank
reads one word and writes one word a cycle. No order of work draws an element in fewer cycles than
its busiest bank has words of it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..host.errors import InputError
from ..host.frame import Frame
from ..rtl.format import ROWS, EngineConfig
from .bank_model import walk_banks
from .expand import expand_frame, slots
from .golden import block_rows, decode, render
from .lane_model import least_lane_cycles, walk_lanes
from .pipeline_model import machine_of

__all__ = ["LAYOUTS", "bound_cycles", "clearing_cycles", "count_cycles", "least_cycles"]

LAYOUTS = {
    "whole columns": "bank = line mod 8; all lines take the same column of words at a time",
    "lines apart": "bank = line mod 8; each line takes the words that its row touches",
    "interleaved": "bank = (line + 4 (word mod 2)) mod 8, as an engine of eight banks has it",
    "sixteen": "bank = line mod 8 + 8 (word mod 2), as an engine of sixteen has it",
}
"""The layouts compared: three with the same sixteen block RAMs, one with twice as many."""


REGISTERS = 6
"""Table writes of a frame beside the materials."""

START = 4
"""Cycles that the simulation takes from the reset to the first table write, and from the last one
to the first code word."""


def count_cycles(frame: Frame, *, after_reset: bool = True, conflicts: bool = True) -> int:
    """Return the clock cycles that the engine takes for a frame.

    They run from the first code word taken to the end beat, both included: the ``cycles`` of
    ``sim.cosim.frames``, to the cycle. No port ever waits and there is no initial raster.

    Parameters
    ----------
    frame
        What to draw.
    after_reset
        The frame is the engine's first, as in ``simulate_frame``: the window is still being cleared
        when the first code word is taken. False: a later frame, or an engine that had the time.
    conflicts
        False counts as if a bank could take the word that it is writing at the moment. That is not
        always less: an element that waits leaves its other banks to the lines that leave.

    Raises
    ------
    InputError
        If there is no end-of-frame word.
    """
    config = frame.config
    clearing = clearing_cycles(config) if after_reset else 0
    words = slots(np.ascontiguousarray(frame.codewords, np.uint64), config)
    machine = machine_of(config, frame.width, frame.height, clearing)
    walk = walk_lanes if config.lanes else walk_banks
    cycles = walk(words.view(np.int64), machine._replace(hazard=conflicts))
    if not cycles:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")
    return int(cycles)


def clearing_cycles(config: EngineConfig) -> int:
    """Return for how long the window is still cleared when a first frame's first word is taken.

    It takes a cycle an address of a bank (half the words of its lines) or of a lane (a pixel of
    each word of every fourth line), from the reset on; the table writes go before the first code
    word.
    """
    if config.lanes:
        clearing = config.window_lines // 4 << config.word_bits
    else:
        clearing = config.window_lines // (config.banks // 2) << config.word_bits - 1
    writes = config.register_base + REGISTERS
    return max(clearing - writes - START, 0)


def bound_cycles(frame: Frame) -> int:
    """Return the least cycles that the layout of the engine's memory leaves for a frame.

    The largest of three. Each element takes as many as its busiest bank has words, or its busiest
    lane pixels. Of the raster one beat leaves in a cycle. And a bank, or lane, takes one word, or
    pixel, in a cycle: all that are drawn and all that leave, were they spread evenly.
    """
    frame = expand_frame(frame)
    words = np.ascontiguousarray(frame.codewords, np.uint64)
    fields = decode(words, frame.config)
    elements = words[~fields["control"]].view(np.int64)
    if frame.config.lanes:
        pixels = frame.config.pixels_per_word
        drawing = least_lane_cycles(elements, pixels)
        memories, of_a_word = 4 * pixels, pixels
        accesses = _covered_pixels(fields[~fields["control"]])
    else:
        layout = "interleaved" if frame.config.banks == 8 else "sixteen"
        drawing = round(least_cycles(frame)[layout] * len(elements)) if len(elements) else 0
        memories, of_a_word = frame.config.banks, 1
        accesses = int(_touched_words(frame).sum())
    drawn = render(frame).drawn
    leaving = _groups(drawn, frame.config.pixels_per_word)
    beats = _groups(drawn, frame.config.raster_pixels)
    return max(int(drawing), beats, -(-(accesses + of_a_word * leaving) // memories))


def least_cycles(frame: Frame) -> dict[str, float]:
    """Return the mean least cycles of an element, for each of ``LAYOUTS``.

    Clipping is left out: a word that lies outside the image counts as one inside.
    """
    touched = _touched_words(frame)
    columns = touched.any(axis=1).sum(axis=1)
    rows = touched.sum(axis=2).max(axis=1)
    upper, lower = touched[:, :ROWS], touched[:, ROWS:]
    # Of three neighbouring words a bank holds the outer two of one line and the middle one of the
    # line four above or below.
    outer_upper = upper[..., 0] + upper[..., 2] + lower[..., 1]
    outer_lower = lower[..., 0] + lower[..., 2] + upper[..., 1]
    banks = np.maximum(outer_upper, outer_lower).max(axis=1)
    lines = np.maximum(touched[..., 0] + touched[..., 2], touched[..., 1]).max(axis=1)
    cycles = dict(zip(LAYOUTS, (columns, rows, banks, lines), strict=True))
    return {name: float(np.maximum(taken, 1).mean()) for name, taken in cycles.items()}


def _groups(drawn: npt.NDArray[np.bool_], pixels: int) -> int:
    """Return in how many groups of so many neighbouring pixels of a line something was drawn."""
    starts = range(0, drawn.shape[1], pixels)
    return int(np.count_nonzero(np.add.reduceat(drawn, starts, axis=1)))


def _covered_pixels(fields: npt.NDArray[np.void]) -> int:
    """Return how many pixels elements cover, each for itself."""
    first, last = block_rows(fields)
    return int(np.maximum(last - first + 1, 0).sum())


def _touched_words(frame: Frame) -> npt.NDArray[np.int64]:
    """Return which of three neighbouring words each row touches: shape (elements, 8, 3), 0 or 1."""
    fields = decode(expand_frame(frame).codewords, frame.config)
    fields = fields[~fields["control"]]
    first, last = block_rows(fields)
    offset = (fields["x"].astype(np.int64) % frame.config.pixels_per_word)[:, np.newaxis]
    begin, end = (first + offset) // 4, (last + offset) // 4
    word = np.arange(3)
    inside = (begin[..., np.newaxis] <= word) & (word <= end[..., np.newaxis])
    return (inside & (first <= last)[..., np.newaxis]).astype(np.int64)
