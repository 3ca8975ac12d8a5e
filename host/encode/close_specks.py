"""Closes specks: pixels at which a picture shows through a surface.

Discs leave gaps by chance. A pinhole shows the background, and a pixel that is seen through shows a
layer behind. Gaps of several pixels are small areas of background (:mod:`.areas`). All are found in
the drawn image, as Rosenthal and Linsen do in *Image-space point cloud rendering* (CGI 2008), and
drawn as one more element for each pixel. So the engine needs nothing new, and the Verilog draws the
closed picture as well.
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

from .areas import find_areas
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
    """Return a frame that also draws its pinholes, its small areas, and what is seen through.

    A pinhole, or a pixel that is seen through, gets the depth and the look of a neighbour: the one
    whose depth is the median of the drawn neighbours'. The second of two rounds closes what is left
    where specks touch. Then a pixel of a small area gets those of the nearest pixel about the area.

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
    y, x = _close(depth, owner, words, config)
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
    depth: npt.NDArray[np.int32],
    owner: npt.NDArray[np.int32],
    words: npt.NDArray[np.uint64],
    config: EngineConfig,
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Close the specks of an image in its own arrays; return their lines and columns."""
    background = config.background_depth
    first = _round(depth, owner, background, _candidates(depth, background))
    # What is left has a closed pixel in its neighbourhood.
    done = np.zeros(depth.shape, np.bool_)
    done.ravel()[first] = True
    near = np.flatnonzero(_extreme(done, np.maximum, False))
    second = _round(depth, owner, background, near)
    pixels, sources = find_areas(depth, owner, words, config)
    _copy(depth, owner, pixels, sources)
    return np.divmod(np.unique(np.concatenate([first, second, pixels])), depth.shape[1])


def _copy(
    depth: npt.NDArray[np.int32],
    owner: npt.NDArray[np.int32],
    pixels: npt.NDArray[np.int64],
    sources: npt.NDArray[np.int64],
) -> None:
    """Give pixels the depth and the look of others; both are counted line by line."""
    for image in (depth, owner):
        image.ravel()[pixels] = image.ravel()[sources]


def _candidates(depth: npt.NDArray[np.int32], background: int) -> npt.NDArray[np.int64]:
    """Return the pixels that may be specks, counted line by line.

    Most pixels lie close to the nearest in their neighbourhood.
    """
    behind = depth - _extreme(depth, np.minimum, background)
    is_far = 2 * behind * STEP[1] > 2 * STEP[0] * (background - 1)
    return np.flatnonzero(np.where(depth == background, behind > 0, is_far))


def _extreme(image: npt.NDArray[Any], of: np.ufunc, outside: Any) -> npt.NDArray[Any]:
    """Return the least or the largest value of each pixel's 3 x 3 neighbourhood."""
    padded = np.pad(image, 1, constant_values=outside)
    lines = of(of(padded[:-2], padded[1:-1]), padded[2:])
    found: npt.NDArray[Any] = of(of(lines[:, :-2], lines[:, 1:-1]), lines[:, 2:])
    return found


def _round(
    depth: npt.NDArray[np.int32],
    owner: npt.NDArray[np.int32],
    background: int,
    candidates: npt.NDArray[np.int64],
) -> npt.NDArray[np.int64]:
    """Close those of some pixels that are specks; return them, counted line by line."""
    sources = np.empty(len(candidates), np.int64)
    _find(depth, background, candidates, sources)
    specks, sources = candidates[sources >= 0], sources[sources >= 0]
    _copy(depth, owner, specks, sources)
    return specks


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


@cached_njit()
def _find(depth: Any, background: int, pixels: Any, sources: Any) -> None:
    """Find the neighbour that each speck takes its depth from.

    Parameters
    ----------
    depth
        Shape (height, width), int32.
    background
        Depth of pixels that nothing was drawn into.
    pixels
        Those that may be specks, counted line by line: shape (n,), int64.
    sources
        Set to the number of the neighbour, -1 if a pixel is no speck: shape (n,), int64.
    """
    height, width = depth.shape
    ranked = np.empty(8, np.int64)
    for number, pixel in enumerate(pixels):
        y, x = pixel // width, pixel % width
        own, found = np.int64(depth[y, x]), 0
        for line in range(max(y - 1, 0), min(y + 2, height)):
            for column in range(max(x - 1, 0), min(x + 2, width)):
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
        sources[number] = -1
        if found and _is_speck(own, background, ranked, found):
            sources[number] = ranked[(found - 1) // 2] & (1 << NUMBER_BITS) - 1


@nb.njit(inline="always")
def _is_speck(own: int, background: int, ranked: Any, found: int) -> bool:
    """Return whether a pixel is a speck, by its own depth and those of its drawn neighbours."""
    if own == background:
        return found >= ENCLOSED
    # The median of an even number of depths is the mean of two. Those below it are neighbours' if
    # the own depth is above.
    low = ranked[found // 2] >> NUMBER_BITS
    high = low
    if found % 2:
        high = own
        if found > 1:
            high = min(ranked[found // 2 + 1] >> NUMBER_BITS, own)
    return (2 * own - low - high) * STEP[1] > 2 * STEP[0] * (background - 1)
