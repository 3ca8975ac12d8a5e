"""The raster that a frame starts from, of any stream of beats (``docs/contract.md``, "Raster")."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.fields import Field
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import LIMB

__all__ = ["loaded_raster"]


def loaded_raster(
    beats: npt.NDArray[np.uint64], width: int, height: int, config: EngineConfig
) -> Raster:
    """Return the raster of beats of an initial raster, which may be any.

    Beats outside the image are dropped, and those on a line above that of the last beat that was
    not. Of a word that comes twice the second counts.

    Parameters
    ----------
    beats
        Shape (n, limbs), uint64; no end beat among them.
    width, height
        Size of the image in pixels.
    config
        The engine's configuration.
    """
    pixels = config.raster_pixels
    lines = _take(beats, config.raster_line).astype(np.int64)
    words = _take(beats, config.raster_word).astype(np.int64)
    inside = (lines < height) & (words * pixels < width)
    beats, lines, words = beats[inside], lines[inside], words[inside]
    kept = lines >= np.maximum.accumulate(lines) if len(lines) else inside[:0]
    beats, lines, words = beats[kept], lines[kept], words[kept]
    depth = np.full((height, -(-width // pixels) * pixels), config.background_depth, np.uint16)
    colour = np.zeros(depth.shape, np.uint32)
    # Of equal places numpy keeps the last value.
    for pixel in range(pixels):
        depth[lines, words * pixels + pixel] = _take(beats, config.raster_depth(pixel))
        colour[lines, words * pixels + pixel] = _take(beats, config.raster_colour(pixel))
    return Raster.from_words(depth[:, :width], colour[:, :width], config)


def _take(beats: npt.NDArray[np.uint64], field: Field) -> npt.NDArray[np.uint64]:
    """Return a field of each beat."""
    limb, shift = divmod(field.lsb, LIMB)
    bits = beats[:, limb] >> np.uint64(shift)
    if shift + field.width > LIMB:
        bits = bits | beats[:, limb + 1] << np.uint64(LIMB - shift)
    return bits & np.uint64(field.mask)
