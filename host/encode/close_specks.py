"""Closes specks: single pixels at which a picture shows through a surface.

Discs leave gaps by chance. A pinhole shows the background, and a pixel that is seen through shows a
layer behind. Both are found in the drawn image, as Rosenthal and Linsen do in *Image-space point
cloud rendering* (CGI 2008), and drawn as one more element of one pixel. So the engine needs nothing
new, and the Verilog draws the closed picture as well.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.config import ROWS, EngineConfig
from splatline.contract.frame import Frame
from splatline.contract.plane import LOW_BITS, Z_FRACTION
from splatline.host.compiled_cache import cached_njit

from .owners import as_encoded, elements_of, find_owners
from .sort_by_line import sort_by_line
from .write_words import ONE_PIXEL

__all__ = ["ENCLOSED", "STEP", "close_specks"]

ENCLOSED = 7
"""Drawn neighbours, of eight, from which on a background pixel is a pinhole."""

STEP = 25, 511
"""Share of the depth range by which a pixel that is seen through lies behind the median of the
drawn pixels in its 3 x 3 neighbourhood, as a fraction."""

NUMBER_BITS = 32
"""Bits of a pixel's number beside its depth."""


def close_specks(frame: Frame, own: tuple[slice, slice] | None = None) -> Frame:
    """Return a frame that also draws its pinholes, and the pixels that are seen through.

    Such a pixel gets the depth and the look of a neighbour: the one whose depth is the median of
    the drawn neighbours'. The second of two rounds closes what is left where specks touch.

    Parameters
    ----------
    frame
        A frame without compact words.
    own
        Lines and columns of the pixels that are closed, as a tile's (``Tile.own``). The frame
        has to draw ``tile.HEM`` pixels beyond them whole. None: all.

    Returns
    -------
    Frame
        Its ``counts`` has ``specks``, the number of pixels, and what the longer stream has of
        ``codewords``, ``control_words`` and ``bits_sent``.

    Raises
    ------
    InputError
        If the frame has no end word.
    """
    config, size = frame.config, (frame.width, frame.height)
    words, lines = elements_of([frame], config)
    depth, owner = find_owners(words, lines, size, config)
    y, x = _close(depth, owner, config.background_depth)
    if own is not None:
        inside = np.zeros(depth.shape, np.bool_)
        inside[own] = True
        y, x = y[inside[y, x]], x[inside[y, x]]
    counts = {**frame.counts, "specks": len(y)}
    if not len(y):
        return dataclasses.replace(frame, counts=counts)
    closing = _one_pixel(words[owner[y, x]], x, depth[y, x], config)
    encoded = as_encoded(
        np.concatenate([words, closing]), np.concatenate([lines, y + ROWS]), frame.height
    )
    stream, control_words = sort_by_line(encoded, config)
    counts |= {"codewords": len(stream), "control_words": control_words}
    if "bits_sent" in counts:
        counts["bits_sent"] = dict.fromkeys(counts["bits_sent"], config.codeword_bits * len(stream))
    return dataclasses.replace(frame, codewords=stream, counts=counts)


def _close(
    depth: npt.NDArray[np.int32], owner: npt.NDArray[np.int32], background: int
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Close the specks of an image in its own arrays; return their lines and columns."""
    height, width = depth.shape
    nearest = np.full(depth.shape, -1, np.int32)
    _find(depth, background, nearest)
    y, x = np.nonzero(nearest >= 0)
    closed = y * width + x
    _take(depth, owner, closed, nearest[y, x])
    # What is left has a closed pixel in its neighbourhood.
    around = [(y + down) * width + x + right for down in (-1, 0, 1) for right in (-1, 0, 1)]
    inside = [
        (y + down >= 0) & (y + down < height) & (x + right >= 0) & (x + right < width)
        for down in (-1, 0, 1)
        for right in (-1, 0, 1)
    ]
    again = np.unique(np.concatenate(around)[np.concatenate(inside)])
    sources = _find_again(depth, background, again)
    _take(depth, owner, again[sources >= 0], sources[sources >= 0])
    return np.divmod(np.union1d(closed, again[sources >= 0]), width)


def _take(
    depth: npt.NDArray[np.int32],
    owner: npt.NDArray[np.int32],
    to: npt.NDArray[np.int64],
    source: npt.NDArray[np.int32],
) -> None:
    """Copy depths and owners from pixels to others; both are counted line by line."""
    for image in (depth, owner):
        image.ravel()[to] = image.ravel()[source]


def _one_pixel(
    words: npt.NDArray[np.uint64],
    x: npt.NDArray[np.int64],
    depth: npt.NDArray[np.int32],
    config: EngineConfig,
) -> npt.NDArray[np.uint64]:
    """Return words of one pixel each, with the look of other words.

    Parameters
    ----------
    words
        Elements that have the look: shape (n,) or (n, 2).
    x, depth
        Column and depth of each pixel.
    config
        Where the fields are.
    """
    low = words[:, 0] if config.plane else words
    look = sum(
        field.mask << field.lsb for field in (config.diffuse, config.specular, config.material)
    )
    scans = np.uint64(1 | ONE_PIXEL << config.scans.lsb)
    made = low & np.uint64(look) | scans | x.astype(np.uint64) << np.uint64(config.x.lsb)
    z = depth.astype(np.uint64)
    if not config.plane:
        return made | z << np.uint64(config.z.lsb)
    # A plane without slopes.
    return np.stack([made, z << np.uint64(Z_FRACTION + config.z.lsb - LOW_BITS)], axis=1)


@cached_njit(parallel=True)
def _find(depth: Any, background: int, nearest: Any) -> None:
    """Find the specks, and the neighbour that each takes its depth from.

    Parameters
    ----------
    depth
        Shape (height, width), int32.
    background
        Depth of pixels that nothing was drawn into.
    nearest
        Set where there is a speck to the number of the neighbour, counted line by line: shape of
        ``depth``, int32.
    """
    height, width = depth.shape
    for y in nb.prange(height):
        ranked = np.empty(8, np.int64)
        for x in range(width):
            source = _source(depth, y, x, background, ranked)
            if source >= 0:
                nearest[y, x] = source


@cached_njit()
def _find_again(depth: Any, background: int, pixels: Any) -> Any:
    """Return for each of some pixels what :func:`_find` would set, -1 if it is no speck."""
    ranked = np.empty(8, np.int64)
    sources = np.empty(len(pixels), np.int32)
    for number, pixel in enumerate(pixels):
        y, x = pixel // depth.shape[1], pixel % depth.shape[1]
        sources[number] = _source(depth, y, x, background, ranked)
    return sources


@nb.njit(inline="always")
def _source(depth: Any, y: int, x: int, background: int, ranked: Any) -> int:
    """Return the neighbour that a speck takes its depth from, -1 if a pixel is no speck.

    ``ranked`` is overwritten: shape (8,), int64.
    """
    height, width = depth.shape
    top, bottom, left, right = max(y - 1, 0), min(y + 2, height), max(x - 1, 0), min(x + 2, width)
    # Most pixels lie close to the nearest in their neighbourhood.
    own = np.int64(depth[y, x])
    least = own
    for line in range(top, bottom):
        for column in range(left, right):
            least = min(least, np.int64(depth[line, column]))
    is_close = not _is_far(2 * (own - least), background)
    if least == own or (is_close and own != background):
        return -1
    found = 0
    for line in range(top, bottom):
        for column in range(left, right):
            near = np.int64(depth[line, column])
            if near != background and (line != y or column != x):
                # Depths in ascending order, each with the number of its pixel.
                value = near << NUMBER_BITS | line * width + column
                at = found
                while at > 0 and ranked[at - 1] > value:
                    ranked[at] = ranked[at - 1]
                    at -= 1
                ranked[at] = value
                found += 1
    if own == background:
        is_speck = found >= ENCLOSED
    else:
        # The median of an even number of depths is the mean of two. Those below it are neighbours'
        # if the own depth is above.
        low = ranked[found // 2] >> NUMBER_BITS
        high = low
        if found % 2:
            high = own
            if found > 1:
                high = min(ranked[found // 2 + 1] >> NUMBER_BITS, own)
        is_speck = _is_far(2 * own - low - high, background)
    if not is_speck:
        return -1
    return ranked[(found - 1) // 2] & (1 << NUMBER_BITS) - 1


@nb.njit(inline="always")
def _is_far(twice: Any, background: int) -> Any:
    """Return whether half of a difference of depths is more than ``STEP``."""
    return twice * STEP[1] > 2 * STEP[0] * (background - 1)
