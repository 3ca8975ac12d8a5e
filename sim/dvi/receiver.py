"""The receiver: finds characters in the bits of three channels, and refreshes in the characters."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from .tmds import BITS, control_codes, decode

__all__ = ["DviError", "Screen", "receive", "unpack_pins"]

CHANNELS = 3

RUN = 8
"""Control characters in a row, by which a receiver finds the place of a character."""


class DviError(ValueError):
    """The bits are no picture."""


class Screen(NamedTuple):
    """A picture on a screen.

    Parameters
    ----------
    pictures
        All whole refreshes: shape (refreshes, lines, columns, 3), uint8; red, green, blue.
    characters
        From one VSYNC to the next.
    skew
        Bits by which channels 1 and 2 are behind channel 0.
    """

    pictures: npt.NDArray[np.uint8]
    characters: int
    skew: tuple[int, int]


def unpack_pins(record: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Return the pins of each bit: shape (bits,); channel n is bit n, and the clock is bit 3.

    Parameters
    ----------
    record
        A record of the bench: bytes of two bits, the first in the low half.
    """
    pins = np.empty(2 * len(record), np.uint8)
    pins[::2] = record & 15
    pins[1::2] = record >> 4
    return pins


def receive(pins: npt.NDArray[np.uint8]) -> Screen:
    """Return the pictures that pins show.

    Parameters
    ----------
    pins
        Result of :func:`unpack_pins`: at least one refresh, and the VSYNCs before and after it.

    Raises
    ------
    DviError
        If a channel has no characters, channels are apart by more than half a character (a real
        receiver bears 0.6, table 4-5 of the specification), or refreshes differ in their timing.
    """
    phases, channels = [], []
    for channel in range(CHANNELS):
        phase, characters = _characters((pins >> channel & 1).astype(np.uint8))
        phases.append(phase)
        channels.append(characters)
    skews = [_skew(phase - phases[0]) for phase in phases[1:]]
    # Where the first whole character is not that of the others, it is left out of the others.
    late = [(p - phases[0] - skew) // BITS for p, skew in zip(phases, [0, *skews], strict=True)]
    channels = [c[max(late) - n :] for c, n in zip(channels, late, strict=True)]
    length = min(len(characters) for characters in channels)
    characters = np.stack([c[:length] for c in channels])
    codes = control_codes(characters)
    enabled = codes < 0
    if (enabled != enabled[0]).any():
        raise DviError("the channels differ in where they have data")
    return _refreshes(characters, codes[0], enabled[0], (skews[0], skews[1]))


def _characters(bits: npt.NDArray[np.uint8]) -> tuple[int, npt.NDArray[np.uint16]]:
    """Return the place of a channel's first character, and all of them."""
    weights = (1 << np.arange(BITS)).astype(np.uint16)
    best, found = (0, np.zeros(0, np.uint16)), -1
    for phase in range(BITS):
        usable = (len(bits) - phase) // BITS * BITS
        words = bits[phase : phase + usable].reshape(-1, BITS) @ weights
        control = control_codes(words) >= 0
        runs = int(np.lib.stride_tricks.sliding_window_view(control, RUN).all(axis=1).sum())
        if runs > found:
            best, found = (phase, words), runs
    if found <= 0:
        raise DviError("a channel has no run of control characters")
    return best


def _skew(bits: int) -> int:
    """Return a distance of characters that is nearest to 0."""
    return (bits + BITS // 2) % BITS - BITS // 2


def _refreshes(
    characters: npt.NDArray[np.uint16],
    codes: npt.NDArray[np.int8],
    enabled: npt.NDArray[np.bool_],
    skew: tuple[int, int],
) -> Screen:
    """Cut the characters at each rise of VSYNC."""
    # VSYNC does not change while there is data: there it is that of the last control character.
    known = np.maximum.accumulate(np.where(enabled, 0, np.arange(len(codes))))
    vsync = codes[known] >> 1 & 1
    rises = np.flatnonzero(np.diff(vsync.astype(np.int8)) == 1) + 1
    if len(rises) < 2:
        raise DviError("there is no whole refresh")
    lengths = np.diff(rises)
    if (lengths != lengths[0]).any():
        raise DviError(f"refreshes have different lengths: {sorted(set(lengths.tolist()))}")
    pictures = []
    for begin, end in zip(rises[:-1].tolist(), rises[1:].tolist(), strict=True):
        shown = enabled[begin:end]
        edges = np.flatnonzero(np.diff(shown.astype(np.int8)))
        if len(edges) == 0 or len(edges) % 2:
            raise DviError("a refresh has no lines")
        widths = edges[1::2] - edges[::2]
        if (widths != widths[0]).any():
            raise DviError("lines of a refresh have different lengths")
        values = decode(characters[:, begin:end][:, shown])
        # Channel 0 is blue, 1 green, 2 red.
        pictures.append(values[::-1].T.reshape(len(widths), int(widths[0]), CHANNELS))
    if len({picture.shape for picture in pictures}) > 1:
        raise DviError("refreshes have different sizes")
    return Screen(np.stack(pictures), int(lengths[0]), skew)
