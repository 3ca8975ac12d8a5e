"""The raster stream of ``docs/contract.md``: pictures to beats and back."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..rtl.format import EngineConfig, Field
from .raster import Raster

__all__ = ["from_beats", "to_beats"]

LIMB = 64


def to_beats(raster: Raster) -> npt.NDArray[np.uint64]:
    """Return a picture as raster beats, the end beat last; words of background are left out.

    Parameters
    ----------
    raster
        The picture.

    Returns
    -------
    numpy.ndarray
        Shape (n, limbs), uint64: each beat's bits, the lowest 64 in column 0.
    """
    config = raster.config
    height, width = raster.depth.shape
    across = config.pixels_per_word
    words = -(-width // across)
    depth = np.full((height, words * across), config.background_depth, np.uint64)
    colour = np.zeros((height, words * across), np.uint64)
    depth[:, :width] = raster.depth
    for channel in range(3):
        level = raster.colour[:, :, channel].astype(np.uint64)
        colour[:, :width] |= level << np.uint64(channel * config.channel_bits)
    depth = depth.reshape(height, words, across)
    colour = colour.reshape(height, words, across)
    line, word = np.nonzero((depth != config.background_depth).any(axis=2))

    beats = np.zeros((len(line) + 1, -(-config.raster_end.end // LIMB)), np.uint64)
    body = beats[:-1]
    for pixel in range(across):
        _put(body, config.raster_depth(pixel), depth[line, word, pixel])
        _put(body, config.raster_colour(pixel), colour[line, word, pixel])
    _put(body, config.raster_word, word.astype(np.uint64))
    _put(body, config.raster_line, line.astype(np.uint64))
    _put(beats[-1:], config.raster_end, np.ones(1, np.uint64))
    return beats


def from_beats(
    beats: npt.NDArray[np.uint64], width: int, height: int, config: EngineConfig
) -> Raster:
    """Return the picture that raster beats describe, and hold them to the contract.

    Parameters
    ----------
    beats
        As :func:`to_beats` returns them.
    width, height
        Size of the image in pixels.
    config
        The engine that they come from.

    Raises
    ------
    ValueError
        If a beat lies outside the image, is out of order or repeated, holds anything but
        background outside the image or colour in the background, or if the end beat is not the
        last and only one.
    """
    across = config.pixels_per_word
    ends = _get(beats, config.raster_end)
    if not len(beats) or not ends[-1]:
        raise ValueError("the raster stream has no end beat")
    if ends[:-1].any():
        raise ValueError(f"beats follow the end beat {int(np.argmax(ends))}")
    body = beats[:-1]
    line = _get(body, config.raster_line).astype(np.int64)
    word = _get(body, config.raster_word).astype(np.int64)
    words = -(-width // across)
    outside = (line >= height) | (word >= words)
    if outside.any():
        at = int(np.argmax(outside))
        raise ValueError(f"beat {at} lies outside the image: line {line[at]}, word {word[at]}")
    place = line * words + word
    unsorted = np.diff(place) <= 0
    if unsorted.any():
        raise ValueError(f"beat {int(np.argmax(unsorted)) + 1} is out of order or repeated")

    depth = np.full((height, words * across), config.background_depth, np.uint16)
    colour = np.zeros((height, words * across), np.uint64)
    for pixel in range(across):
        depth[line, word * across + pixel] = _get(body, config.raster_depth(pixel))
        colour[line, word * across + pixel] = _get(body, config.raster_colour(pixel))
    background = depth == config.background_depth
    if not background[:, width:].all():
        raise ValueError("a pixel is drawn outside the image")
    if colour[background].any():
        raise ValueError("a pixel at the background's depth has a colour")
    channels = [
        colour[:, :width] >> np.uint64(channel * config.channel_bits)
        & np.uint64(config.channel_max)
        for channel in range(3)
    ]
    return Raster(depth[:, :width].copy(), np.stack(channels, axis=-1).astype(np.uint8), config)


def _put(
    beats: npt.NDArray[np.uint64], field: Field, values: npt.NDArray[np.uint64]
) -> None:
    """Write a field into beats that hold zeros there; it may lie across two limbs."""
    limb, shift = divmod(field.lsb, LIMB)
    beats[:, limb] |= values << np.uint64(shift)
    if shift + field.width > LIMB:
        beats[:, limb + 1] |= values >> np.uint64(LIMB - shift)


def _get(beats: npt.NDArray[np.uint64], field: Field) -> npt.NDArray[np.uint64]:
    """Return a field of beats."""
    limb, shift = divmod(field.lsb, LIMB)
    values = beats[:, limb] >> np.uint64(shift)
    if shift + field.width > LIMB:
        values = values | beats[:, limb + 1] << np.uint64(LIMB - shift)
    return values & np.uint64(field.mask)
