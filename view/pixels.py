"""Pixels as bytes of red, green, blue and alpha."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.raster import Raster
from splatline.host.compiled_cache import cached_njit

__all__ = ["opaque", "rgba_bytes"]


def rgba_bytes(
    rasters: Sequence[Raster], background: tuple[float, float, float]
) -> npt.NDArray[np.uint8]:
    """Return the mean of some rasters as red, green, blue and alpha.

    The levels are those of ``plots.figure.rgb_levels``, bit for bit: the same sums of float64 in
    the same order.

    Parameters
    ----------
    rasters
        One for each sample of a pixel; at least one, all of one size and configuration.
    background
        RGB in 0..1 of the pixels that nothing was drawn into.

    Returns
    -------
    numpy.ndarray
        Shape (height, width, 4), uint8; alpha is 255.
    """
    first = rasters[0]
    out = np.empty((*first.depth.shape, 4), np.uint8)
    channels = np.arange(256) / float(first.config.channel_max)
    clear = np.asarray(background, np.float64)
    empty = first.config.background_depth
    total = np.zeros((*first.depth.shape, 3)) if len(rasters) > 1 else np.zeros((1, 1, 3))
    for number, raster in enumerate(rasters):
        step = number, len(rasters)
        _add(raster.depth, raster.colour, empty, channels, clear, step, total, out)
    return out


def opaque(levels: npt.NDArray[np.integer[Any]]) -> npt.NDArray[np.uint8]:
    """Return levels of 0 to 255, shape (height, width, 3 or 1), with an alpha of 255."""
    rgba = np.full((*levels.shape[:2], 4), 255, np.uint8)
    rgba[..., :3] = levels
    return rgba


@cached_njit(parallel=True, error_model="numpy")
def _add(
    depth: npt.NDArray[np.uint16],
    colour: npt.NDArray[np.uint8],
    empty: int,
    channels: npt.NDArray[np.float64],
    clear: npt.NDArray[np.float64],
    step: tuple[int, int],
    total: npt.NDArray[np.float64],
    out: npt.NDArray[np.uint8],
) -> None:
    """Add a raster to the total; after the last one, set the bytes."""
    number, of = step
    height, width = depth.shape
    for line in nb.prange(height):
        for column in range(width):
            drawn = depth[line, column] != empty
            for channel in range(3):
                value = channels[colour[line, column, channel]] if drawn else clear[channel]
                if number:
                    value = total[line, column, channel] + value
                if number + 1 < of:
                    total[line, column, channel] = value
                else:
                    mean = value / of
                    out[line, column, channel] = np.uint8(np.rint(min(max(mean, 0.0), 1.0) * 255.0))
            out[line, column, 3] = 255
