"""Counts the cycles that the Verilog takes for a frame, without a simulation."""

from __future__ import annotations

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.contract.frame import Frame
from splatline.sim.golden.compact_words import slots

from .blocks import count_blocks
from .front import halves_of, machine_of
from .tiles import NO_TRACE, count_tiles

__all__ = ["clearing_cycles", "count_cycles"]

REGISTERS = 6
"""Table writes of a frame beside the materials."""

START = 4
"""Cycles that the simulation takes from the reset to the first table write, and from the last one
to the first code word."""


def count_cycles(frame: Frame, *, after_reset: bool = True, conflicts: bool = True) -> int:
    """Return the clock cycles that the engine takes for a frame.

    They are counted from the first code word taken to the end beat, both included, and are exactly
    the ``cycles`` of ``sim.cosim.player.frames``. Every port is always ready or valid, and there is
    no initial raster.

    Parameters
    ----------
    frame
        The frame.
    after_reset
        The frame is the first after reset, as in ``simulate_frame``: the window is still being
        cleared when the first code word is taken. False: the window is clear.
    conflicts
        False: tiles do not stall for read-after-write hazards. That does not always take fewer
        cycles, because flushes use the lanes of a tile that stalls.

    Raises
    ------
    InputError
        If there is no end-of-frame word.
    """
    config = frame.config
    clearing = clearing_cycles(config) if after_reset else 0
    words, highs = halves_of(slots(frame.codewords, config), config)
    machine = machine_of(config, frame.width, frame.height, clearing)
    machine = machine._replace(hazard=conflicts)
    if config.draws_blocks:
        cycles = count_blocks(words, highs, machine)
    else:
        cycles = count_tiles(words, highs, machine, NO_TRACE)
    if not cycles:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")
    return int(cycles)


def clearing_cycles(config: EngineConfig) -> int:
    """Return the cycles of clearing that are left when the first code word after reset is taken.

    Clearing takes one cycle for each address of a lane. The table writes come before the first code
    word. A lane has a pixel of each word of every fourth line (tiles), or of half the words of
    every eighth line (blocks).
    """
    clearing = config.window_lines // config.tile_lines << config.word_bits
    clearing //= config.raster_words
    writes = config.register_base + REGISTERS
    return max(clearing - writes - START, 0)
