"""Occlusion culling with a coarse depth pyramid, which is filled as words are made.

The lower level has a cell for every 8 x 4 pixels. Nothing visible in a cell lies beyond the cell's
``bound``. A cell gathers nearer words until they cover all of its pixels. Then their largest depth
is the new bound (after Andersson, Hasselgren and Akenine-Moeller, *Masked Depth Culling for
Graphics Hardware*, 2015). A splat is hidden if it is beyond the bound of each cell that it may
touch: each pixel there has a smaller depth from another word, so the splat draws nothing, whatever
the order of the words.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.codeword import decode_plane_word, decode_word, plane_at, plane_fields
from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.plane import SUM_FRACTION
from splatline.host.compiled_cache import cached_njit

__all__ = ["Pyramid", "cover", "cover_planes", "is_hidden", "new_pyramid"]

WIDE, HIGH = BLOCK, ROWS
"""Pixels of a cell: those of a fraction, one for each bit of a 32-bit mask."""

FULL = (1 << WIDE * HIGH) - 1

GROUP = 8
"""Cells on each side of a cell of the upper level."""

MOST_CELLS = 64
"""Most cells of a level that are tested for a splat; a larger splat counts as visible."""

BANDS = 8
"""Bands of the cells' rows, which are filled in parallel."""


class Pyramid(NamedTuple):
    """Depths by cell: shape (rows, columns), and by groups of cells.

    Parameters
    ----------
    bound
        No visible depth is larger: int32.
    mask, gathered
        Pixels that nearer words cover, and the largest depth of these: uint32, int32.
    coarse
        Largest bound of each group of cells: int32.
    """

    bound: npt.NDArray[np.int32]
    mask: npt.NDArray[np.uint32]
    gathered: npt.NDArray[np.int32]
    coarse: npt.NDArray[np.int32]


def new_pyramid(width: int, height: int, config: EngineConfig) -> Pyramid:
    """Return a pyramid that hides nothing."""
    rows, columns = -(-height // HIGH), -(-width // WIDE)
    inside = np.zeros((rows * HIGH, columns * WIDE), np.uint32)
    inside[:height, :width] = 1
    bits = np.uint32(1) << np.arange(WIDE * HIGH, dtype=np.uint32)
    cells = inside.reshape(rows, HIGH, columns, WIDE).transpose(0, 2, 1, 3)
    outside = np.uint32(FULL) - (cells.reshape(rows, columns, -1) * bits).sum(axis=2)
    background = config.background_depth
    return Pyramid(
        bound=np.full((rows, columns), background, np.int32),
        mask=outside.astype(np.uint32),  # nothing can be drawn there
        gathered=np.zeros((rows, columns), np.int32),
        coarse=np.full((-(-rows // GROUP), -(-columns // GROUP)), background, np.int32),
    )


@nb.njit(error_model="numpy")
def is_hidden(
    column: float, line: float, wide: float, high: float, z: int, bound: Any, coarse: Any
) -> bool:
    """Return whether every cell that a splat may touch shows something nearer.

    Parameters
    ----------
    column, line
        Centre on the image.
    wide, high
        Pixels that it may reach to either side.
    z
        Its least depth.
    bound, coarse
        Of the pyramid.
    """
    rows, columns = bound.shape
    left = int(max(column - wide, 0.0)) // WIDE
    right = int(min(max(column + wide, 0.0), columns * WIDE - 1.0)) // WIDE
    top = int(max(line - high, 0.0)) // HIGH
    bottom = int(min(max(line + high, 0.0), rows * HIGH - 1.0)) // HIGH
    cells = bound
    if (right + 1 - left) * (bottom + 1 - top) > MOST_CELLS:
        cells = coarse
        left, right, top, bottom = left // GROUP, right // GROUP, top // GROUP, bottom // GROUP
        if (right + 1 - left) * (bottom + 1 - top) > MOST_CELLS:
            return False
    for row in range(top, bottom + 1):
        for cell in range(left, right + 1):
            if z <= cells[row, cell]:
                return False
    return True


def cover(
    pyramid: Pyramid,
    words: npt.NDArray[np.uint64],
    lines: npt.NDArray[np.int16],
    starts: npt.NDArray[np.int64],
    stops: npt.NDArray[np.int64],
    config: EngineConfig,
) -> None:
    """Add words, given in chunks, to a pyramid."""
    fields = (config.x.lsb, config.x.mask, config.z.lsb, config.z.mask)
    bound, mask, gathered, coarse = pyramid
    _cover(words.view(np.int64), lines, starts, stops, fields, bound, mask, gathered)
    _coarsen(bound, coarse)


def cover_planes(
    pyramid: Pyramid,
    words: npt.NDArray[np.uint64],
    lines: npt.NDArray[np.int16],
    starts: npt.NDArray[np.int64],
    stops: npt.NDArray[np.int64],
    config: EngineConfig,
) -> None:
    """Add plane words, shape (slots, 2), given in chunks, to a pyramid.

    A word counts as if all its pixels had the largest depth among them.
    """
    fields = (config.x.lsb, config.x.mask), plane_fields(config), config.background_depth
    bound, mask, gathered, coarse = pyramid
    _cover_planes(words.view(np.int64), lines, starts, stops, fields, bound, mask, gathered)
    _coarsen(bound, coarse)


def _coarsen(bound: npt.NDArray[np.int32], coarse: npt.NDArray[np.int32]) -> None:
    """Set the upper level of a pyramid from the lower one."""
    rows, columns = bound.shape
    padded = np.zeros((coarse.shape[0] * GROUP, coarse.shape[1] * GROUP), np.int32)
    padded[:rows, :columns] = bound
    coarse[:] = padded.reshape(coarse.shape[0], GROUP, coarse.shape[1], GROUP).max(axis=(1, 3))


@nb.njit
def _add_block(
    block: Any, top: int, x: int, z: int, first: int, end: int, bound: Any, mask: Any, gathered: Any
) -> None:
    """Add a word's block, with the largest depth of its pixels, to the cells of some rows.

    Parameters
    ----------
    block
        First and last column of each of its rows; see ``contract.codeword.decode_word``.
    top, x
        Its first line and column.
    z
        The depth.
    first, end
        Rows of cells.
    bound, mask, gathered
        See :class:`Pyramid`.
    """
    column = x // WIDE
    for row in range(first, end):
        both = _row_masks(block, top, row, x % WIDE)
        _add(both & FULL, z, row, column, bound, mask, gathered)
        if both >> WIDE * HIGH and column + 1 < bound.shape[1]:
            _add(both >> WIDE * HIGH & FULL, z, row, column + 1, bound, mask, gathered)


@cached_njit(parallel=True)
def _cover(
    words: Any,
    lines: Any,
    starts: Any,
    stops: Any,
    fields: Any,
    bound: Any,
    mask: Any,
    gathered: Any,
) -> None:
    """Fill the cells: each band reads all words and takes those that touch it."""
    x_lsb, x_mask, z_lsb, z_mask = fields
    rows = len(bound)
    for band in nb.prange(BANDS):
        first_row, end_row = rows * band // BANDS, rows * (band + 1) // BANDS
        block = np.empty((BLOCK, 2), np.int64)
        for chunk in range(len(starts)):
            for i in range(starts[chunk], stops[chunk]):
                top = lines[i] - ROWS  # of the block's first row
                if top >= end_row * HIGH or top + BLOCK <= first_row * HIGH:
                    continue
                word = words[i]
                x, z = word >> x_lsb & x_mask, word >> z_lsb & z_mask
                decode_word(word, block)
                end = min(-(-(top + (ROWS if word & 1 else BLOCK)) // HIGH), end_row)
                first = max(top // HIGH, first_row)
                _add_block(block, top, x, z, first, end, bound, mask, gathered)


@cached_njit(parallel=True)
def _cover_planes(
    words: Any,
    lines: Any,
    starts: Any,
    stops: Any,
    fields: Any,
    bound: Any,
    mask: Any,
    gathered: Any,
) -> None:
    """Fill the cells with plane words, as :func:`_cover` does with others."""
    (x_lsb, x_mask), plane, background = fields
    rows = len(bound)
    for band in nb.prange(BANDS):
        first_row, end_row = rows * band // BANDS, rows * (band + 1) // BANDS
        block = np.empty((BLOCK, 2), np.int64)
        for chunk in range(len(starts)):
            for i in range(starts[chunk], stops[chunk]):
                top = lines[i] - ROWS  # of the block's first row
                if top >= end_row * HIGH or top + BLOCK <= first_row * HIGH:
                    continue
                low, high = words[i, 0], words[i, 1]
                x = low >> x_lsb & x_mask
                decode_plane_word(low, high, block)
                z = _largest_depth(high, block, plane, background)
                end = min(-(-(top + (ROWS if low & 1 else BLOCK)) // HIGH), end_row)
                first = max(top // HIGH, first_row)
                _add_block(block, top, x, z, first, end, bound, mask, gathered)


@nb.njit
def _largest_depth(high: int, block: Any, plane: Any, background: int) -> int:
    """Return the largest depth of a plane word's pixels."""
    start, a, b = plane_at(high, plane)
    furthest = -(1 << 40)
    for row in range(BLOCK):
        first, last = block[row]
        if first <= last:
            furthest = max(furthest, b * row + max(a * first, a * last))
    return min(max(start + furthest >> SUM_FRACTION, 0), background)


@nb.njit
def _row_masks(block: Any, top: int, cell_row: int, offset: int) -> int:
    """Return which pixels of a cell (low half) and of the next (high half) a block covers."""
    both = 0
    for k in range(HIGH):
        row = cell_row * HIGH + k - top
        if 0 <= row < BLOCK:
            first, last = block[row]
            if first <= last:
                bits = ((2 << last) - (1 << first)) << offset
                both |= (bits & 255) << WIDE * k | (bits >> WIDE) << WIDE * (HIGH + k)
    return both


@nb.njit
def _add(pixels: int, z: int, row: int, column: int, bound: Any, mask: Any, gathered: Any) -> None:
    """Add a word's pixels of a cell."""
    if pixels == 0 or z >= bound[row, column]:
        return
    covered = np.int64(mask[row, column]) | pixels
    largest = max(int(gathered[row, column]), z)
    if covered == FULL:
        bound[row, column] = largest
        # The cell gathers still nearer words. Outside of the image there is nothing to cover.
        covered, largest = np.int64(0), 0
    mask[row, column] = covered
    gathered[row, column] = largest
