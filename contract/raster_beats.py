"""The raster stream of ``docs/contract.md``: converts a raster to beats, and beats to a raster.

A stream is an array of 64-bit limbs, the lowest first, one row a beat.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .config import EngineConfig
from .fields import Field
from .presets import PAPER
from .raster import Raster

__all__ = ["from_beats", "put_field", "to_beats"]

_Limbs = npt.NDArray[np.uint64]
LIMB = 64
"""Bits of a limb."""


def to_beats(raster: Raster) -> npt.NDArray[np.uint64]:
    """Return the beats of a raster.

    Parameters
    ----------
    raster
        Depth and colour of every pixel.

    Returns
    -------
    numpy.ndarray
        Shape (n, limbs), uint64, lowest limb first: the words that are not all background, in order
        of lines and of words in a line, and the end beat.

    Raises
    ------
    ValueError
        If the image is larger than the raster's configuration allows.
    """
    config = raster.config
    pixels = config.raster_pixels
    height, width = raster.depth.shape
    if width > config.max_width or height > config.max_height:
        raise ValueError(f"a raster of {width}x{height} pixels does not fit {config.name!r}")
    spare = -width % pixels
    depth = np.pad(
        raster.depth, ((0, 0), (0, spare)), constant_values=np.uint16(config.background_depth)
    )
    colour = np.pad(raster.colour_words, ((0, 0), (0, spare)))
    drawn = (depth != config.background_depth).reshape(height, -1, pixels)
    lines, words = np.nonzero(drawn.any(axis=2))

    beats = np.zeros((len(lines) + 1, -(-config.raster_end.end // LIMB)), np.uint64)
    for pixel in range(pixels):
        columns = words * pixels + pixel
        put_field(beats[:-1], config.raster_depth(pixel), depth[lines, columns])
        put_field(beats[:-1], config.raster_colour(pixel), colour[lines, columns])
    put_field(beats[:-1], config.raster_word, words)
    put_field(beats[:-1], config.raster_line, lines)
    put_field(beats[-1:], config.raster_end, np.ones(1))
    return beats


def from_beats(
    beats: npt.NDArray[np.uint64], width: int, height: int, config: EngineConfig = PAPER
) -> Raster:
    """Return the raster of a stream of beats; check that an engine may send them.

    Parameters
    ----------
    beats
        Shape (n, limbs), uint64, lowest limb first; the end beat comes last.
    width, height
        Size of the image in pixels.
    config
        The configuration of the engine that sent them.

    Raises
    ------
    ValueError
        If the end beat is missing or not the last. If a beat lies outside the image, is out of
        order or repeated, has bits above its fields, or draws nothing. If a pixel beyond the last
        column is drawn, or one at background depth has a colour.
    """
    limbs = -(-config.raster_end.end // LIMB)
    if beats.ndim != 2 or beats.shape[1] != limbs:
        raise ValueError(f"beats must have the shape (n, {limbs}), not {beats.shape}")
    beats = beats.astype(np.uint64, copy=False)
    ends = np.flatnonzero(_get(beats, config.raster_end))
    if len(ends) == 0:
        raise ValueError(f"none of {len(beats)} beats is the end of the frame")
    if ends[0] != len(beats) - 1:
        raise ValueError(f"beat {ends[0]} of {len(beats)} ends the frame, but is not the last")
    unused = Field(config.raster_end.end, LIMB * limbs - config.raster_end.end)
    if unused.width and _get(beats, unused).any():
        raise ValueError("a beat has bits above its end bit")
    beats = beats[:-1]
    lines = _get(beats, config.raster_line).astype(np.int64)
    words = _get(beats, config.raster_word).astype(np.int64)
    _check_positions(lines, words, width, height, config)

    pixels = config.raster_pixels
    padded = (height, width + -width % pixels)
    depth = np.full(padded, config.background_depth, np.uint16)
    colour = np.zeros(padded, np.uint32)
    for pixel in range(pixels):
        columns = words * pixels + pixel
        depth[lines, columns] = _get(beats, config.raster_depth(pixel))
        colour[lines, columns] = _get(beats, config.raster_colour(pixel))
    if colour[depth == config.background_depth].any():
        raise ValueError("a pixel at background depth has a colour")
    if (depth[:, width:] != config.background_depth).any():
        raise ValueError("a pixel beyond the last column was drawn")
    drawn = (depth.reshape(height, -1, pixels) != config.background_depth).any(axis=2)
    empty = np.flatnonzero(~drawn[lines, words])
    if len(empty):
        first = empty[0]
        name = f"word {words[first]} of line {lines[first]}"
        raise ValueError(f"beat {first} is {name}, in which nothing was drawn")
    return Raster.from_words(depth[:, :width], colour[:, :width], config)


def _check_positions(
    lines: npt.NDArray[np.int64],
    words: npt.NDArray[np.int64],
    width: int,
    height: int,
    config: EngineConfig,
) -> None:
    """Raise if raster words are out of order, repeated or outside the image."""
    outside = np.flatnonzero((lines >= height) | (words * config.raster_pixels >= width))
    if len(outside):
        beat = outside[0]
        raise ValueError(
            f"beat {beat} is word {words[beat]} of line {lines[beat]}, outside {width}x{height}"
        )
    positions = lines << config.raster_word.width | words
    wrong = np.flatnonzero(positions[1:] <= positions[:-1])
    if len(wrong):
        beat = wrong[0] + 1
        raise ValueError(
            f"beat {beat} is word {words[beat]} of line {lines[beat]}, after word"
            f" {words[beat - 1]} of line {lines[beat - 1]}"
        )


def put_field(beats: _Limbs, field: Field, values: npt.NDArray[np.generic]) -> None:
    """Set a field of at most 64 bits in beats of several limbs.

    The field must be 0 before. It may cross into the next limb.
    """
    limb, shift = divmod(field.lsb, LIMB)
    bits = values.astype(np.uint64)
    beats[:, limb] |= bits << np.uint64(shift)
    if shift + field.width > LIMB:
        beats[:, limb + 1] |= bits >> np.uint64(LIMB - shift)


def _get(beats: _Limbs, field: Field) -> _Limbs:
    """Return a field of at most 64 bits."""
    limb, shift = divmod(field.lsb, LIMB)
    bits = beats[:, limb] >> np.uint64(shift)
    if shift + field.width > LIMB:
        bits = bits | beats[:, limb + 1] << np.uint64(LIMB - shift)
    return bits & np.uint64(field.mask)
