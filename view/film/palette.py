"""One palette for a whole film, and ordered dithering with it."""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.materials import median_cut

__all__ = ["BAYER", "SKIPPED", "Palette", "find_palette", "index_frame"]

SKIPPED = 255
"""Index of a pixel that stays as it was in the frame before."""

LEVEL_BITS = 6
"""Bits of a channel in the table of nearest colours."""

SPREAD = 12.0
"""Levels over which the dithering spreads a channel: about the distance of two near colours."""

PIXELS = 1 << 16
"""Pixels that the palette is made from."""

REFINEMENTS = 3
"""Steps of k-means after the median cut."""


def _bayer(bits: int) -> npt.NDArray[np.float64]:
    """Return the thresholds of an ordered dither, from -0.5 to 0.5: shape (2^bits, 2^bits).

    B. E. Bayer, *An optimum method for two-level rendition of continuous-tone pictures*, 1973.
    """
    order = np.zeros((1, 1))
    for _ in range(bits):
        order = np.block([[4 * order, 4 * order + 2], [4 * order + 3, 4 * order + 1]])
    return (order + 0.5) / order.size - 0.5


BAYER = _bayer(3)


class Palette(NamedTuple):
    """The colours of a film.

    Parameters
    ----------
    colours
        Shape (256, 3), uint8; the last one stands for ``SKIPPED``, and the first is the background.
    nearest
        Index of the nearest colour by the upper bits of red, green and blue: shape (2^18,), uint8.
    """

    colours: npt.NDArray[np.uint8]
    nearest: npt.NDArray[np.uint8]


def find_palette(frames: list[npt.NDArray[np.uint8]], background: tuple[int, int, int]) -> Palette:
    """Return the colours that fit some frames of a film best.

    Parameters
    ----------
    frames
        Frames from all over the film: each of shape (height, width, 3), uint8.
    background
        Red, green and blue of the background, which the palette has as it is.
    """
    from scipy.spatial import cKDTree

    pixels = np.concatenate([frame.reshape(-1, 3) for frame in frames])
    pixels = pixels[(pixels != background).any(axis=1)]
    if not len(pixels):
        pixels = np.array([background], np.uint8)
    some = pixels[np.linspace(0, len(pixels) - 1, min(len(pixels), PIXELS)).astype(np.int64)]
    entries = median_cut(some, SKIPPED - 1, REFINEMENTS)
    known = np.concatenate([np.array([background], np.uint8), entries])
    colours = np.zeros((256, 3), np.uint8)
    colours[: len(known)] = known

    step = 1 << (8 - LEVEL_BITS)
    levels = np.arange(1 << LEVEL_BITS) * step + 0.5 * (step - 1)
    cells = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 3)
    nearest = cKDTree(known.astype(np.float64)).query(cells)[1].astype(np.uint8)
    return Palette(colours, nearest)


@cached_njit(parallel=True)
def index_frame(
    pixels: npt.NDArray[np.uint8],
    nearest: npt.NDArray[np.uint8],
    thresholds: npt.NDArray[np.float64],
    background: npt.NDArray[np.uint8],
    shown: npt.NDArray[np.uint8],
    changed: npt.NDArray[np.uint8],
) -> None:
    """Set the indices of a frame's colours, and which of them differ from the frame before.

    The thresholds lie still in the image, so a pixel that keeps its colour keeps its index: nothing
    flickers, as it would if errors were carried on to other pixels. The background is not dithered.

    Parameters
    ----------
    pixels
        Shape (height, width, 3), uint8.
    nearest
        See :class:`Palette`.
    thresholds
        Shape (8, 8), in levels.
    background
        Red, green and blue, of index 0: shape (3,), uint8.
    shown
        Indices of the frame before, which become those of this one: shape (height, width), uint8.
    changed
        Gets the index of each pixel that differs, and ``SKIPPED`` for the others: the same shape.
    """
    height, width = shown.shape
    for line in nb.prange(height):
        for column in range(width):
            red, green, blue = pixels[line, column]
            if red == background[0] and green == background[1] and blue == background[2]:
                index = np.uint8(0)
            else:
                more = thresholds[line % 8, column % 8]
                cell = 0
                for channel in range(3):
                    level = min(max(pixels[line, column, channel] + more, 0.0), 255.0)
                    cell = (cell << LEVEL_BITS) | (int(level + 0.5) >> (8 - LEVEL_BITS))
                index = nearest[cell]
            changed[line, column] = SKIPPED if index == shown[line, column] else index
            shown[line, column] = index
