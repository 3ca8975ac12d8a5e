"""Stand-ins for plane words: one uint64 each, so that what sorts words of 64 bits sorts them."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.frame import are_control
from splatline.host.compiled_cache import cached_njit

__all__ = ["X_LSB", "number_of", "replace", "stand_in"]

X_LSB = 48
"""Lowest bit of X in a stand-in. Below it lie the number of the word, and a 0 as its MODE, so that
no stand-in is a control word; bit 63 is 1, which it is in no control word of a host."""


def stand_in(words: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[np.uint64]:
    """Return a stand-in for each plane word that draws, and the low half of each control word.

    Parameters
    ----------
    words
        Shape (n, 2), uint64.
    config
        Where X is.

    Returns
    -------
    numpy.ndarray
        Shape (n,), uint64.
    """
    x = words[:, 0] >> np.uint64(config.x.lsb) & np.uint64(config.x.mask)
    numbers = np.arange(len(words), dtype=np.uint64) << np.uint64(1)
    found = numbers | x << np.uint64(X_LSB) | np.uint64(1 << 63)
    control = are_control(words[:, 0], config)
    found[control] = words[control, 0] & np.uint64((1 << 63) - 1)
    return found


def replace(
    stream: npt.NDArray[np.uint64], words: npt.NDArray[np.uint64]
) -> npt.NDArray[np.uint64]:
    """Return a stream with the words in place of their stand-ins: shape (n, 2), uint64.

    Control words get an empty high half.
    """
    found = np.empty((len(stream), 2), np.uint64)
    _replace(stream, words, found)
    return found


@nb.njit(inline="always")
def number_of(word: Any) -> Any:
    """Return the number of the plane word that a stand-in stands for."""
    return word >> np.uint64(1) & np.uint64((1 << X_LSB - 1) - 1)


@cached_njit(parallel=True)
def _replace(stream: Any, words: Any, found: Any) -> None:
    """Fill in the words of a stream."""
    for i in nb.prange(len(stream)):
        word = stream[i]
        if word >> np.uint64(63):
            number = number_of(word)
            found[i, 0], found[i, 1] = words[number, 0], words[number, 1]
        else:
            found[i, 0], found[i, 1] = word, np.uint64(0)
