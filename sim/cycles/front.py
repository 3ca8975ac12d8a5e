"""The engine's clock, as a program: what each stage holds from cycle to cycle.

It follows the circuit of ``rtl/`` stage by stage, but only in what decides about time. Here are the
stages before the window, which all engines share; :mod:`splatline.sim.cycles.tiles` and
:mod:`splatline.sim.cycles.blocks` have the windows.

All ports are willing in every cycle and there is no initial raster.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.contract.codeword import COLUMN, FIRST, LAST
from splatline.contract.config import BLOCK, COMPACT, ROWS, EngineConfig
from splatline.contract.presets import PAPER

__all__ = [
    "ABOVE",
    "EMPTY",
    "END_WORD",
    "FIRST_STAGE",
    "FOLLOWING",
    "HEAD",
    "Front",
    "Machine",
    "advance",
    "machine_of",
    "new_front",
]

FIRST_STAGE, HEAD = 0, 1
"""The pipeline's stages before the window: the table of materials, and the decoder."""

EMPTY = -1
"""In place of a code word's index: a stage holds none."""

ABOVE = BLOCK // 2
"""Lines from a block's first row to the line that the engine is at."""

# These have the same place in every configuration, so that the compiler may know it.
MARK_LSB, MARK_MASK = PAPER.compact_mark.lsb, PAPER.compact_mark.mask

ROM_STAGES = 3
"""Stages of the shape ROM, where there is one."""


class Machine(NamedTuple):
    """What the clock depends on beside the code words.

    Parameters
    ----------
    x_lsb, x_mask, end_lsb
        Places of a code word's fields.
    last_column, last_line
        Size of the image less 1.
    lowest
        The line at which a block's top stays, far below every image.
    half_words
        Half the words of a line.
    clearing
        Cycles, from the first code word on, in which the window is still being cleared.
    hazard
        A lane cannot take the pixel that it writes at that moment. False is a machine that could.
    z_lsb, z_mask
        Place of a code word's depth; the mask is the background's depth as well.
    lines
        Lines of the window.
    pixels
        Pixels in a word of the window's memory.
    block_words
        Words of a line that an element touches at most.
    raster_words
        Of them in a beat of the raster.
    rom
        The engine has a shape ROM.
    pair_lsb
        Place of the bit by which ``sim.golden.compact_words.slots`` tells that the next word is of
        the same one.
    flush_words
        Words that leave lanes at one request: of two the second leaves a cycle later.
    """

    x_lsb: int
    x_mask: int
    end_lsb: int
    last_column: int
    last_line: int
    lowest: int
    half_words: int
    clearing: int
    hazard: bool
    z_lsb: int
    z_mask: int
    lines: int
    pixels: int
    block_words: int
    raster_words: int
    rom: bool
    pair_lsb: int
    flush_words: int


def machine_of(config: EngineConfig, width: int, height: int, clearing: int = 0) -> Machine:
    """Return the machine of a configuration that draws an image of a size."""
    return Machine(
        x_lsb=config.x.lsb,
        x_mask=config.x.mask,
        end_lsb=config.control_end.lsb,
        last_column=width - 1,
        last_line=height - 1,
        lowest=(1 << (config.line_bits + 1)) - 1,
        half_words=1 << (config.word_bits - 1),
        clearing=clearing,
        hazard=True,
        z_lsb=config.z.lsb,
        z_mask=config.z.mask,
        lines=config.window_lines,
        pixels=config.pixels_per_word,
        block_words=config.block_words,
        raster_words=config.raster_words,
        rom=config.shapes != "none",
        pair_lsb=config.material.lsb,
        flush_words=config.flush_words,
    )


FOLLOWING, TOP_LINE, END_WORD = range(3)
"""What ``Front.state`` has: the next code word; the first line of a block at the engine's line; the
index of the frame's end word, or ``EMPTY`` until it was taken."""


class Front(NamedTuple):
    """The stages before the window.

    Parameters
    ----------
    held
        Index of each stage's code word, or ``EMPTY``: shape (2,).
    tops
        Its block's first line: shape (2,).
    state
        See ``FOLLOWING`` and what follows: shape (3,).
    rom, rom_tops
        As ``held`` and ``tops``, of the shape ROM, which lies before them: shape (3,).
    """

    held: Any
    tops: Any
    state: Any
    rom: Any
    rom_tops: Any


@nb.njit(cache=True)
def new_front() -> Front:
    """Return empty stages before the first code word."""
    state = np.array([0, -ABOVE, EMPTY])
    held, rom = np.full(HEAD + 1, EMPTY, np.int64), np.full(ROM_STAGES, EMPTY, np.int64)
    return Front(held, np.zeros_like(held), state, rom, np.zeros_like(rom))


@nb.njit(cache=True)
def advance(words: Any, front: Front, done: bool, machine: Machine, rigid: bool = False) -> bool:
    """Let a cycle pass; return whether the last stage took something, or nothing, anew.

    Every stage moves on if what it holds is taken or it holds nothing. Control words that advance
    the line need no stage.

    Parameters
    ----------
    words
        The code words; with a shape ROM, ``sim.golden.compact_words.slots``.
    front
        Changed.
    done
        The window takes what the last stage holds.
    machine
        The engine.
    rigid
        The last stage moves on only then, though it may hold nothing.
    """
    held, tops, state = front.held, front.tops, front.state
    head_moves = done or (held[HEAD] == EMPTY and not rigid)
    moves = head_moves
    for stage in range(HEAD, FIRST_STAGE, -1):
        moves = moves or (stage < HEAD and held[stage] == EMPTY)
        if moves:
            held[stage], tops[stage] = held[stage - 1], tops[stage - 1]
            held[stage - 1] = EMPTY
    first, first_tops = held[: FIRST_STAGE + 1], tops[: FIRST_STAGE + 1]
    if machine.rom:
        _advance_rom(words, front, machine)
        first, first_tops = front.rom, front.rom_tops
    if state[END_WORD] == EMPTY:
        following = state[FOLLOWING]
        word = words[following]
        if _is_control(word) and not word >> machine.end_lsb & 1:
            step = word >> machine.x_lsb & machine.x_mask
            state[TOP_LINE] = min(state[TOP_LINE] + step, machine.lowest)
            state[FOLLOWING] += 1
        elif first[0] == EMPTY:
            ends = _is_control(word)
            first[0] = following
            first_tops[0] = machine.lowest if ends else state[TOP_LINE]
            state[END_WORD] = following if ends else EMPTY
            state[FOLLOWING] += 2 if machine.rom and _is_pair(word, machine) else 1
    return head_moves


@nb.njit(cache=True)
def _advance_rom(words: Any, front: Front, machine: Machine) -> None:
    """Let the words in the shape ROM move on; what gives nothing leaves its end by itself.

    A word of which two come is one in the first stage, and stays there for the second of them.
    """
    held, tops, rom, rom_tops = front.held, front.tops, front.rom, front.rom_tops
    last = ROM_STAGES - 1
    if rom[last] != EMPTY and _is_compact(words[rom[last]]):
        rom[last] = EMPTY
    if held[FIRST_STAGE] == EMPTY:
        held[FIRST_STAGE], tops[FIRST_STAGE] = rom[last], rom_tops[last]
        rom[last] = EMPTY
    for stage in range(last, 0, -1):
        if rom[stage] == EMPTY:
            rom[stage], rom_tops[stage] = rom[stage - 1], rom_tops[stage - 1]
            two = stage == 1 and rom[0] != EMPTY and _is_pair(words[rom[0]], machine)
            rom[stage - 1] = rom[0] + 1 if two else EMPTY


@nb.njit(cache=True, inline="always")
def _is_pair(word: int, machine: Machine) -> bool:
    return word >> machine.pair_lsb & 1 == 1


@nb.njit(cache=True, inline="always")
def _is_compact(word: int) -> bool:
    return not word & 1 and word >> MARK_LSB & MARK_MASK == COMPACT


@nb.njit(cache=True, inline="always")
def _is_control(word: int) -> bool:
    empty = True
    for row in range(ROWS):
        empty &= (word >> FIRST[row] & COLUMN) > (word >> LAST[row] & COLUMN)
    return (word & 1 == 1) & empty
