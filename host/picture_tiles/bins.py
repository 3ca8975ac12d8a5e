"""Sorts splats by tile: each goes to every tile of a row that it may touch."""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit
from splatline.host.encode.tile import GUARD_COLUMNS, HEM, Tile
from splatline.host.visibility.splats import COLUMN, DIAMETER, LINE, SPLAT, Splats
from splatline.host.visibility.view import LARGEST, View

from .grid import Grid

__all__ = ["Bin", "bins_of_row"]

BESIDE = 12.0
"""Pixels by which the blocks of a splat's words may reach beyond its disc: up to a pixel as
positions and diameters of the quality ``paper`` are whole, and eight that a block is wide."""

WIDEST = 0.99
"""Radius of a disc, as a share of its distance, up to which its image is bounded."""


class Bin(NamedTuple):
    """The splats of a tile.

    Parameters
    ----------
    tile
        The tile.
    splats
        The splats that may touch it, in positions of the whole picture.
    slots
        The slot of each among all splats: shape (slots,), int64.
    """

    tile: Tile
    splats: Splats
    slots: npt.NDArray[np.int64]


def bins_of_row(splats: Splats, view: View, grid: Grid, number: int) -> list[Bin]:
    """Return the splats of each tile of a row.

    Parameters
    ----------
    splats
        All splats of the picture.
    view
        The whole picture's.
    grid, number
        The picture's tiles, and the row's number.
    """
    tiles = grid.row(number)
    chunks = len(splats.starts)
    top = tiles[0].place[0].start - HEM
    row = top, tiles[0].bottom, grid.step[0], grid.columns
    middle_x, middle_y = view.middle
    camera = 1.0 / view.focal, middle_x, middle_y
    floats = splats.views()[0]
    counts = np.zeros((grid.columns, chunks), np.int64)
    _count(floats, splats.starts, splats.stops, camera, row, counts)
    ends = np.cumsum(counts).reshape(counts.shape)
    starts = ends - counts
    data = np.empty(int(ends[-1, -1]), SPLAT)
    slots = np.empty(len(data), np.int64)
    chunks_of = splats.starts, splats.stops
    _fill(floats, _bits(splats.data), chunks_of, camera, row, starts.copy(), _bits(data), slots)
    bins = []
    for tile, own_starts, own_ends in zip(tiles, starts, ends, strict=True):
        first, end = int(own_starts[0]), int(own_ends[-1])
        own = Splats(
            data[first:end], own_starts - first, own_ends - first, splats.nearest,
            splats.depth_range, {},
        )  # fmt: skip
        bins.append(Bin(tile, own, slots[first:end]))
    return bins


def _bits(data: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Return splats as integers, which are copied as they are: shape (slots, 4)."""
    return data.view(np.int64).reshape(len(data), SPLAT.itemsize // 8)


@nb.njit(inline="always", error_model="numpy")
def _tiles_of(
    column: float, line: float, diameter: float, camera: Any, row: Any
) -> tuple[int, int]:
    """Return the first and last tile of a row that a splat may touch; first > last if none.

    A disc of radius R at the depth z, seen at the slant a = x / z, reaches at most
    sqrt(1 + a^2) R / (z - R) from its centre (see ``cull.lies_outside``).

    Parameters
    ----------
    column, line, diameter
        Of the splat.
    camera
        1 over the focal length, and the position of the view's axis.
    row
        First line of the row of tiles, the line behind its last, columns from tile to tile, and
        number of tiles.
    """
    inverse_focal, middle_x, middle_y = camera
    top, bottom, step, tiles = row
    radius = 0.5 * diameter
    share = radius * inverse_focal
    if share > WIDEST:
        return 0, tiles - 1
    larger = radius / (1.0 - share)
    high = larger * (1.0 + abs(line - middle_y) * inverse_focal) + BESIDE
    if line + high < top or line - high > bottom:
        return 0, -1
    wide = larger * (1.0 + abs(column - middle_x) * inverse_focal) + BESIDE
    left = min(max(column - wide, 0.0), LARGEST)
    right = min(max(column + wide, 0.0), LARGEST)
    first = (int(left) - GUARD_COLUMNS) // step
    last = (int(right) - GUARD_COLUMNS + 2 * HEM) // step
    return min(max(first, 0), tiles - 1), min(max(last, 0), tiles - 1)


@cached_njit(parallel=True, error_model="numpy")
def _count(floats: Any, starts: Any, stops: Any, camera: Any, row: Any, counts: Any) -> None:
    """Count the splats of each tile and chunk: shape (tiles, chunks)."""
    for chunk in nb.prange(len(starts)):
        for i in range(starts[chunk], stops[chunk]):
            column, line = float(floats[i, COLUMN]), float(floats[i, LINE])
            first, last = _tiles_of(column, line, float(floats[i, DIAMETER]), camera, row)
            for tile in range(first, last + 1):
                counts[tile, chunk] += 1


@cached_njit(parallel=True, error_model="numpy")
def _fill(
    floats: Any,
    bits: Any,
    chunks: Any,
    camera: Any,
    row: Any,
    following: Any,
    data: Any,
    slots: Any,
) -> None:
    """Copy the splats of each tile and chunk to their places.

    Parameters
    ----------
    following
        Where the first of each tile and chunk goes: shape (tiles, chunks). Overwritten.
    data, slots
        Set.
    """
    starts, stops = chunks
    for chunk in nb.prange(len(starts)):
        for i in range(starts[chunk], stops[chunk]):
            column, line = float(floats[i, COLUMN]), float(floats[i, LINE])
            first, last = _tiles_of(column, line, float(floats[i, DIAMETER]), camera, row)
            for tile in range(first, last + 1):
                at = following[tile, chunk]
                following[tile, chunk] = at + 1
                for part in range(bits.shape[1]):
                    data[at, part] = bits[i, part]
                slots[at] = i
