"""Expansion of compact words into plain code words: the shape ROM's contract as a program.

The shapes come from the host's table. The hardware has a table of its own
(``rtl/shapes/table.py``).
"""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.config import BLOCK, COMPACT, ROWS, EngineConfig
from splatline.contract.fields import Field
from splatline.contract.frame import Frame
from splatline.host.encode.shape_table import EMPTY_SCANS, shape_table

__all__ = ["Expansion", "expand", "expand_frame", "slots"]

PARTS = 4
"""Groups of four lines of a shape of sixteen lines."""


class Expansion(NamedTuple):
    """Plain code words and their origins.

    Parameters
    ----------
    words
        Shape (n,), uint64.
    origins
        Index of the code word that each was expanded from: shape (n,), int64, rising.
    """

    words: npt.NDArray[np.uint64]
    origins: npt.NDArray[np.int64]


def expand_frame(frame: Frame) -> Frame:
    """Return a frame without compact words; the frame itself if its engine has no shape ROM.

    The configuration stays the same: an engine with a shape ROM draws plain code words as well.
    """
    if frame.config.shapes == "none":
        return frame
    words = np.ascontiguousarray(frame.codewords, np.uint64)
    return dataclasses.replace(frame, codewords=expand(words, frame.config).words)


def expand(words: npt.NDArray[np.uint64], config: EngineConfig) -> Expansion:
    """Return the plain code words that an engine's shape ROM puts out.

    Parameters
    ----------
    words
        Code words as the host sends them: shape (n,), uint64.
    config
        The engine's configuration; without a ROM no code word is compact.
    """
    plain, used = _plain_words(words, config)
    origins = np.broadcast_to(np.arange(len(words))[:, np.newaxis], plain.shape)
    return Expansion(plain[used], origins[used])


def slots(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.uint64]:
    """Return the code word that the shape ROM handles in each cycle, for the cycle models.

    The result is that of ``expand``, shape (n,), uint64, with two differences. A compact word that
    expands to nothing stays, since its look-up takes a cycle. The lowest bit of the material is
    set if the next code word has the same origin; cycles do not depend on materials.
    """
    if config.shapes == "none":
        return words
    plain, used = _plain_words(words, config)
    looked_up = used.copy()
    looked_up[:, 0] |= ~used.any(axis=1)
    mark = np.uint64(1 << config.material.lsb)
    plain &= ~mark
    plain[used.all(axis=1), 0] |= mark
    return plain[looked_up]


def _plain_words(
    words: npt.NDArray[np.uint64], config: EngineConfig
) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.bool_]]:
    """Return two candidate code words for each, and which of them the ROM puts out.

    Both results have the shape (n, 2). A large compact word expands to a left and a right fraction;
    every other code word uses the first candidate alone.
    """
    compact = _are_compact(words, config)
    size = _take(words, config.compact_size)
    small = compact & (size <= min(BLOCK, config.largest_shape))
    large = compact & (size > BLOCK) & (size <= config.largest_shape)
    plain = np.repeat(words[:, np.newaxis], 2, axis=1)
    used = np.zeros(plain.shape, np.bool_)
    used[:, 0] = ~compact | small
    plain[small, 0] = _put(words[small], config.scans, _entries(words[small], config)[:, 0])
    fractions = _fractions(words[large], config)
    x = _take(words[large], config.x)
    for side in range(2):
        column, scans = x + BLOCK * side, fractions[:, side]
        inside = (scans != EMPTY_SCANS) & (column <= config.x.mask)
        word = _put(words[large] | np.uint64(1 << config.mode.lsb), config.scans, scans)
        word = _put(word, config.x, column & config.x.mask)
        plain[large, side] = np.where(inside, word, words[large])
        used[large, side] = inside
    return plain, used


def _are_compact(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.bool_]:
    """Return which code words are compact."""
    if config.shapes == "none":
        return np.zeros(len(words), np.bool_)
    marked = _take(words, config.compact_mark) == COMPACT
    return marked & (_take(words, config.mode) == 0)


def _entries(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.int64]:
    """Return the shape table's entries for compact words: shape (n, 4)."""
    fields = (config.compact_size, config.compact_level_x, config.compact_level_y)
    size, level_x, level_y = (_take(words, field) for field in fields)
    return shape_table()[size, level_x, level_y].astype(np.int64)


def _fractions(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.int64]:
    """Return the left and the right fraction of large compact words: shape (n, 2)."""
    entries = _entries(words, config)
    part = _take(words, config.compact_part)[:, np.newaxis]
    lower = part >= PARTS // 2
    upper_part = np.where(lower, PARTS - 1 - part, part)
    side = np.where(lower, [[1, 0]], [[0, 1]])
    found = np.take_along_axis(entries, 2 * upper_part + side, axis=1)
    return np.where(lower, _half_turned(found), found)


def _half_turned(scans: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return fractions rotated by 180 degrees; an empty row is written as in the table."""
    result = np.zeros_like(scans)
    for row in range(ROWS):
        first, last = scans >> 6 * row & 7, scans >> 6 * row + 3 & 7
        span = np.where(first <= last, (BLOCK - 1 - last) | (BLOCK - 1 - first) << 3, 1)
        result |= span << 6 * (ROWS - 1 - row)
    return result


def _take(words: npt.NDArray[np.uint64], field: Field) -> npt.NDArray[np.int64]:
    """Return the value of a field in each code word."""
    return (words >> np.uint64(field.lsb) & np.uint64(field.mask)).astype(np.int64)


def _put(
    words: npt.NDArray[np.uint64], field: Field, values: npt.NDArray[np.int64]
) -> npt.NDArray[np.uint64]:
    """Return code words with a field replaced."""
    kept = words & np.uint64(~(field.mask << field.lsb) & (1 << 64) - 1)
    return kept | values.astype(np.uint64) << np.uint64(field.lsb)
