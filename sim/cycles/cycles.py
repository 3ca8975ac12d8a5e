"""How many cycles a frame takes: what the Verilog would count, without running it."""

from __future__ import annotations

import numpy as np

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.sim.golden.compact_words import slots

from .blocks import walk_blocks
from .front import machine_of
from .tiles import walk_lanes

__all__ = ["clearing_cycles", "count_cycles"]

REGISTERS = 6
"""Table writes of a frame beside the materials."""

START = 4
"""Cycles that the simulation takes from the reset to the first table write, and from the last one
to the first code word."""


def count_cycles(frame: Frame, *, after_reset: bool = True, conflicts: bool = True) -> int:
    """Return the clock cycles that the engine takes for a frame.

    They run from the first code word taken to the end beat, both included: the ``cycles`` of
    ``sim.cosim.player.frames``, to the cycle. No port ever waits and there is no initial raster.

    Parameters
    ----------
    frame
        What to draw.
    after_reset
        The frame is the engine's first, as in ``simulate_frame``: the window is still being cleared
        when the first code word is taken. False: it has been, in a frame that took long enough or
        before.
    conflicts
        False counts as if a lane could take the pixel that it is writing at the moment, as rows of
        lanes can. That is not always less: a tile that waits leaves its lanes to the lines that
        leave.

    Raises
    ------
    InputError
        If there is no end-of-frame word.
    """
    config = frame.config
    clearing = clearing_cycles(config) if after_reset else 0
    words = slots(np.ascontiguousarray(frame.codewords, np.uint64), config)
    machine = machine_of(config, frame.width, frame.height, clearing)
    walk = walk_blocks if config.draws_blocks else walk_lanes
    cycles = walk(words.view(np.int64), machine._replace(hazard=conflicts))
    if not cycles:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")
    return int(cycles)


def clearing_cycles(config: EngineConfig) -> int:
    """Return for how long the window is still cleared when a first frame's first word is taken.

    It takes a cycle an address of a lane (a pixel of each word of every fourth line, or of half the
    words of every eighth), from the reset on; the table writes go before the first code word.
    """
    clearing = config.window_lines // config.tile_lines << config.word_bits
    clearing //= config.raster_words
    writes = config.register_base + REGISTERS
    return max(clearing - writes - START, 0)
