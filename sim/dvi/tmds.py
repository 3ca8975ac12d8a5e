"""TMDS characters, after the Digital Visual Interface specification 1.0, section 3."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["BITS", "CONTROL", "control_codes", "decode"]

BITS = 10
"""Bits of a character; bit 0 goes first."""

CONTROL = (0b1101010100, 0b0010101011, 0b0101010100, 0b1010101011)
"""Characters of C1, C0 = 00, 01, 10, 11 (table 3-2 of the specification). On channel 0 C0 is HSYNC
and C1 is VSYNC."""


def _tables() -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.int8]]:
    """Return the byte and the control code of each character; -1: it is none."""
    characters = np.arange(1 << BITS)
    bits = characters[:, None] >> np.arange(BITS) & 1
    # Figure 3-6: bit 9 tells whether bits 0..7 are inverted, bit 8 which of XOR and XNOR.
    data = bits[:, :8] ^ bits[:, 9:]
    pairs = data[:, 1:] ^ data[:, :-1] ^ (1 - bits[:, 8:9])
    values = (np.concatenate([data[:, :1], pairs], axis=1) << np.arange(8)).sum(axis=1)
    codes = np.full(1 << BITS, -1, np.int8)
    codes[list(CONTROL)] = np.arange(len(CONTROL))
    return values.astype(np.uint8), codes


_VALUES, _CODES = _tables()


def decode(characters: npt.NDArray[np.uint16]) -> npt.NDArray[np.uint8]:
    """Return the byte that each character stands for, if it is none of control."""
    return _VALUES[characters]


def control_codes(characters: npt.NDArray[np.uint16]) -> npt.NDArray[np.int8]:
    """Return 0..3, that is C1, C0, of each character; -1 of one that stands for a byte."""
    return _CODES[characters]
