"""Reads a frame's stream: its elements, and the line of each."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import ROWS, EngineConfig
from splatline.contract.errors import InputError
from splatline.host.compiled_cache import cached_njit

from .stand_ins import stand_in

__all__ = ["read_stream"]


def read_stream(
    codewords: npt.NDArray[np.uint64], config: EngineConfig
) -> tuple[npt.NDArray[np.uint64], npt.NDArray[np.int64]]:
    """Return the elements up to the end word, and their lines.

    Parameters
    ----------
    codewords
        Shape (n,), uint64; of an engine with planes (n, 2).
    config
        Where the fields are.

    Returns
    -------
    elements
        Shape (m,), uint64: the words, or the stand-ins of plane words.
    lines
        Shape (m,), int64, ascending.

    Raises
    ------
    InputError
        If there is no end word.
    """
    words = np.ascontiguousarray(codewords, np.uint64)
    elements, lines, ended = _read(stand_in(words, config) if config.plane else words, _at(config))
    if not ended:
        raise InputError("the code words have no end-of-frame word: the stream is cut short")
    return elements, lines


def _at(config: EngineConfig) -> npt.NDArray[np.int64]:
    """Return the lowest bits of a control word's rows, of its end bit and X, and the mask of X."""
    rows = [place.lsb for row in range(ROWS) for place in (config.first(row), config.last(row))]
    return np.array([*rows, config.control_end.lsb, config.x.lsb, config.x.mask], np.int64)


@cached_njit()
def _read(words: Any, fields: Any) -> tuple[Any, Any, bool]:
    """Return the elements up to the end word, their lines, and whether there is an end word."""
    elements = np.empty(len(words), np.uint64)
    lines = np.empty(len(words), np.int64)
    count, line = 0, 0
    for word in words:
        control = word & np.uint64(1) == 1
        row = 0
        while control and row < ROWS:
            first = word >> np.uint64(fields[2 * row]) & np.uint64(7)
            last = word >> np.uint64(fields[2 * row + 1]) & np.uint64(7)
            control = first > last
            row += 1
        if not control:
            elements[count] = word
            lines[count] = line
            count += 1
        elif word >> np.uint64(fields[2 * ROWS]) & np.uint64(1):
            return elements[:count], lines[:count], True
        else:
            step = word >> np.uint64(fields[2 * ROWS + 1]) & np.uint64(fields[2 * ROWS + 2])
            line += int(step)
    return elements[:count], lines[:count], False
