"""Small areas of background within one surface, found in the image of depths.

Where discs leave a gap of several pixels, what is around it is one surface: its depths lie on a
plane. About a true gap they do not, as one part ends before another, or a surface turns away. And
a gap between discs is at most twice as wide as the discs are.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import decode_plane_word, decode_word
from splatline.contract.config import BLOCK, EngineConfig
from splatline.host.compiled_cache import cached_njit

__all__ = ["REACH", "find_areas"]

MOST_PIXELS = 32
"""Most pixels of an area."""

MOST_SIDE = 7
"""Most lines and columns of an area."""

RING = 2
"""Pixels about an area, to all sides, that are drawn. The outline of a noisy surface is frayed: the
background shows between a few points that lie outside, and truly so."""

ALWAYS = 3
"""Lines and columns of an area that is closed whatever the size of the words about it."""

WIDER = 2
"""How many times as long as the largest word about it a larger area may be."""

STEP = 10, 511
"""Share of the depth range, as a fraction, by which the depths about an area may lie off a
plane."""

REACH = MOST_SIDE - 1 + RING
"""Pixels to all sides of one that decide whether it is of an area that is closed."""

SIDE = MOST_SIDE + 2 * RING
"""Lines and columns of an area with its ring."""

AREA, RIM = 1, 2
"""What a pixel of a window is: of the area, or of those that touch it."""


def find_areas(
    depth: npt.NDArray[np.int32],
    owner: npt.NDArray[np.int32],
    words: npt.NDArray[np.uint64],
    config: EngineConfig,
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return the pixels of small areas, and the pixel about its area that is nearest to each.

    Parameters
    ----------
    depth, owner
        The image, see ``find_owners``: shape (height, width), int32.
    words
        What draws it: shape (n,), uint64; of an engine with planes (n, 2).
    config
        Where the fields are.

    Returns
    -------
    pixels, sources
        Shape (m,), int64: numbers of pixels, counted line by line.
    """
    halves = (words[:, 0], words[:, 1]) if config.plane else (words, words[:0])
    low, high = (np.ascontiguousarray(half).view(np.int64) for half in halves)
    found = np.empty((2, depth.size), np.int64)
    count = _find(depth, owner, config.background_depth, low, high, config.plane, found)
    return found[0, :count], found[1, :count]


@cached_njit()
def _find(
    depth: Any, owner: Any, background: int, low: Any, high: Any, is_plane: bool, sources: Any
) -> int:
    """Find the pixel that each pixel of a small area takes its depth and look from.

    Pixels of an area touch at their sides or corners. What decides about an area are the depths
    before any is closed, so their order does not matter.

    Parameters
    ----------
    background
        Depth of pixels that nothing was drawn into.
    low, high
        Halves of the words, int64: shape (n,); ``high`` is empty without planes.
    is_plane
        Whether words have planes.
    sources
        Set, for each pixel of an area, to its number and its source's: shape (2, most), int64.

    Returns
    -------
    int
        How many pixels the areas have.
    """
    height, width = depth.shape
    step = STEP[0] * (background - 1) / STEP[1]
    area, window = np.empty((MOST_PIXELS, 2), np.int64), np.empty((SIDE, SIDE), np.uint8)
    found = 0
    for y in range(RING, height - RING):
        for x in range(RING, width - RING):
            # The first pixel of an area, line by line.
            if depth[y, x] != background or max(depth[y, x - 1], depth[y - 1, x]) == background:
                continue
            count = _flood(depth, background, y, x, area)
            if not count:
                continue
            top, left, side = _outline(depth, background, area[:count], window)
            if not side or not _lies_on_plane(depth[top:, left:], window, step):
                continue
            widest = ALWAYS
            for line in range(SIDE):
                for column in range(SIDE):
                    if side > widest and window[line, column] == RIM:
                        i = owner[top + line, left + column]
                        extent = _extent(low[i], high[i] if is_plane else 0, is_plane)
                        widest = max(widest, WIDER * extent)
            if side > widest:
                continue
            for k in range(count):
                line, column = area[k, 0], area[k, 1]
                at = _nearest(window, line - top, column - left)
                sources[0, found] = line * width + column
                sources[1, found] = (top + at // SIDE) * width + left + at % SIDE
                found += 1
    return found


@nb.njit
def _flood(depth: Any, background: int, y: int, x: int, area: Any) -> int:
    """Set the pixels of an area from its first on, and return their number.

    It is 0 if the area is too large, comes near the image's border, or begins before.
    """
    height, width = depth.shape
    area[0, 0], area[0, 1] = y, x
    count, at = 1, 0
    while at < count:
        for way in range(9):
            line, column = area[at, 0] + way // 3 - 1, area[at, 1] + way % 3 - 1
            if depth[line, column] != background:
                continue
            known = False
            for k in range(count):
                known |= area[k, 0] == line and area[k, 1] == column
            if known:
                continue
            is_inside = RING <= column < width - RING and line < height - RING
            if count == MOST_PIXELS or not is_inside or line < y or (line == y and column < x):
                return 0
            area[count, 0], area[count, 1] = line, column
            count += 1
        at += 1
    return count


@nb.njit
def _outline(depth: Any, background: int, area: Any, window: Any) -> tuple[int, int, int]:
    """Set the window about an area; return its first line and column, and the area's longer side.

    The side is 0 if the area is too wide, or not all of its ring is drawn.
    """
    top, left = area[:, 0].min() - RING, area[:, 1].min() - RING
    side = max(area[:, 0].max() - top, area[:, 1].max() - left) + 1 - RING
    if side > MOST_SIDE:
        return top, left, 0
    window[:] = 0
    for k in range(len(area)):
        window[area[k, 0] - top, area[k, 1] - left] = AREA
    for k in range(len(area)):
        line, column = area[k, 0] - top, area[k, 1] - left
        for b in range(line - RING, line + RING + 1):
            for a in range(column - RING, column + RING + 1):
                if window[b, a] == AREA:
                    continue
                if depth[top + b, left + a] == background:
                    return top, left, 0
                if max(abs(b - line), abs(a - column)) == 1:
                    window[b, a] = RIM
    return top, left, side


@nb.njit(error_model="numpy")
def _lies_on_plane(depth: Any, window: Any, step: float) -> bool:
    """Return whether the depths about an area lie on their plane of least squares.

    Parameters
    ----------
    depth
        The image from the window's first pixel on.
    """
    n, sy, sx, sz = 0, 0.0, 0.0, 0.0
    for y in range(SIDE):
        for x in range(SIDE):
            if window[y, x] == RIM:
                n, sy, sx, sz = n + 1, sy + y, sx + x, sz + depth[y, x]
    sy, sx, sz = sy / n, sx / n, sz / n
    yy, yx, xx, yz, xz = 0.0, 0.0, 0.0, 0.0, 0.0
    for y in range(SIDE):
        for x in range(SIDE):
            if window[y, x] == RIM:
                b, a, z = y - sy, x - sx, depth[y, x] - sz
                yy, yx, xx, yz, xz = yy + b * b, yx + b * a, xx + a * a, yz + b * z, xz + a * z
    # The rim goes all around, so it is on no line.
    square = yy * xx - yx * yx
    down, right = (yz * xx - xz * yx) / square, (xz * yy - yz * yx) / square
    furthest = 0.0
    for y in range(SIDE):
        for x in range(SIDE):
            if window[y, x] == RIM:
                off = depth[y, x] - sz - down * (y - sy) - right * (x - sx)
                furthest = max(furthest, abs(off))
    return furthest <= step


@nb.njit
def _extent(low: int, high: int, is_plane: bool) -> int:
    """Return the longer side of what a word draws."""
    block = np.empty((BLOCK, 2), np.int64)
    if is_plane:
        decode_plane_word(low, high, block)
    else:
        decode_word(low, block)
    widest, lines = 0, 0
    for row in range(BLOCK):
        length = block[row, 1] - block[row, 0] + 1
        widest, lines = max(widest, length), lines + (length > 0)
    return max(widest, lines)


@nb.njit
def _nearest(window: Any, line: int, column: int) -> int:
    """Return the number of the pixel about an area that is nearest to one of its pixels."""
    least, found = 2 * SIDE * SIDE, 0
    for y in range(SIDE):
        for x in range(SIDE):
            square = (y - line) ** 2 + (x - column) ** 2
            if window[y, x] == RIM and square < least:
                least, found = square, y * SIDE + x
    return found
