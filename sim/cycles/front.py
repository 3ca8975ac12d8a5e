"""The cycle model of the stages before the window, which both engines share.

The model follows the hardware stage by stage and cycle by cycle, but only the control, not the
pixels. The windows are in :mod:`splatline.sim.cycles.tiles` and :mod:`splatline.sim.cycles.blocks`.

Every port is always ready or valid, and there is no initial raster.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import COLUMN, FIRST, LAST
from splatline.contract.config import BLOCK, COMPACT, ROWS, EngineConfig
from splatline.contract.presets import PAPER
from splatline.host.compiled_cache import cached_njit
from splatline.sim.golden.plane_kernel import PlaneLayout, plane_layout_of

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
    "halves_of",
    "machine_of",
    "new_front",
]

FIRST_STAGE, HEAD = 0, 1
"""The pipeline stages before the window: the material table, and the decoder."""

EMPTY = -1
"""Index of the code word of an empty stage."""

ABOVE = BLOCK // 2
"""Lines from a block's first row to the engine's current line."""

# The same position in every configuration, as a constant for the compiler.
MARK_LSB, MARK_MASK = PAPER.compact_mark.lsb, PAPER.compact_mark.mask

ROM_STAGES = 3
"""Pipeline stages of the shape ROM."""


class Machine(NamedTuple):
    """The engine and the image, as far as cycles depend on them.

    Parameters
    ----------
    x_lsb, x_mask, end_lsb
        Positions of a code word's fields.
    last_column, last_line
        Size of the image less 1.
    lowest
        The largest first line of a block, far below every image.
    half_words
        Half the words of a line.
    clearing
        Cycles of clearing that are left when the first code word is taken.
    hazard
        Tiles stall for read-after-write hazards.
    z_lsb, z_mask
        Position of a code word's depth. The mask is also the background's depth.
    lines
        Lines of the window.
    pixels
        Pixels of a window word.
    block_words
        Window words of a line that an element touches at most.
    raster_words
        Window words of a beat.
    rom
        The engine has a shape ROM.
    pair_lsb
        Position of the bit with which ``sim.golden.compact_words.slots`` marks the first of two
        words of one compact word.
    flush_words
        Window words of one flush. The second of two is flushed a cycle later.
    plane
        Positions of a plane word's fields; they mean nothing for other engines.
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
    plane: PlaneLayout


def machine_of(config: EngineConfig, width: int, height: int, clearing: int = 0) -> Machine:
    """Return the machine of a configuration and an image size."""
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
        plane=plane_layout_of(config),
    )


def halves_of(
    codewords: npt.NDArray[np.uint64], config: EngineConfig
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the lower 64 bits of code words, and the upper 32 bits of plane words.

    Parameters
    ----------
    codewords
        Shape (n,), or (n, 2) with planes; uint64.

    Returns
    -------
    words
        Shape (n,), int64: the bits of unsigned ones.
    highs
        Shape (n,), int64; shape (0,) for an engine without planes.
    """
    bits = np.ascontiguousarray(codewords, np.uint64).view(np.int64)
    if not config.plane:
        return bits, np.zeros(0, np.int64)
    return np.ascontiguousarray(bits[:, 0]), np.ascontiguousarray(bits[:, 1])


FOLLOWING, TOP_LINE, END_WORD = range(3)
"""Elements of ``Front.state``: index of the next code word; first line of a block at the engine's
current line; index of the frame's end word, or ``EMPTY`` until it is taken."""


class Front(NamedTuple):
    """The stages before the window.

    Parameters
    ----------
    held
        Index of each stage's code word, or ``EMPTY``: shape (2,).
    tops
        First line of its block: shape (2,).
    state
        ``FOLLOWING``, ``TOP_LINE`` and ``END_WORD``: shape (3,).
    rom, rom_tops
        The same as ``held`` and ``tops`` for the shape ROM's stages, which come first: shape (3,).
    """

    held: Any
    tops: Any
    state: Any
    rom: Any
    rom_tops: Any


@cached_njit()
def new_front() -> Front:
    """Return empty stages before the first code word."""
    state = np.array([0, -ABOVE, EMPTY])
    held, rom = np.full(HEAD + 1, EMPTY, np.int64), np.full(ROM_STAGES, EMPTY, np.int64)
    return Front(held, np.zeros_like(held), state, rom, np.zeros_like(rom))


@cached_njit()
def advance(words: Any, front: Front, done: bool, machine: Machine, rigid: bool = False) -> bool:
    """Advance all stages by a cycle; return whether the last stage was loaded.

    A stage is loaded if its code word is taken or it is empty. Control words that advance the line
    use no stage.

    Parameters
    ----------
    words
        The code words' lower 64 bits; with a shape ROM, those of
        ``sim.golden.compact_words.slots``.
    front
        The stages. Changed.
    done
        The window takes the code word of the last stage.
    machine
        The engine and the image.
    rigid
        The last stage is loaded only with ``done``, even if it is empty.
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


@cached_njit()
def _advance_rom(words: Any, front: Front, machine: Machine) -> None:
    """Advance the stages of the shape ROM by a cycle.

    A compact word without an element is dropped at the last stage. A compact word that becomes two
    words uses the first stage for two cycles.
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


@cached_njit(inline="always")
def _is_pair(word: int, machine: Machine) -> bool:
    return word >> machine.pair_lsb & 1 == 1


@cached_njit(inline="always")
def _is_compact(word: int) -> bool:
    return not word & 1 and word >> MARK_LSB & MARK_MASK == COMPACT


@cached_njit(inline="always")
def _is_control(word: int) -> bool:
    empty = True
    for row in range(ROWS):
        empty &= (word >> FIRST[row] & COLUMN) > (word >> LAST[row] & COLUMN)
    return (word & 1 == 1) & empty
