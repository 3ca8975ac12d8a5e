"""Cells of a cloud: cubes of an octree that hold a few points each, for searches of neighbours.

Points are sorted along Morton's curve, on which every cube of the octree is one stretch. A cell is
the largest cube with at most ``CELL_POINTS`` points, so cells are small where points are dense. The
neighbourhood of a cell are the 27 cubes of its size about it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

from .curve import common_levels
from .curve_order import Curve, sort_along_curve
from .prefetch import AHEAD, prefetch

__all__ = ["CELL_POINTS", "Cells", "build_cells", "parts_of", "search_of"]

CELL_POINTS = 16
"""Most points of a cell. Its parent has more, so some of the 27 cubes hold at least as many."""

TABLE_LEVELS = 6
"""Levels whose cubes are looked up in a table; within them a binary search goes on."""

CHUNKS = 1024
"""Pieces of the work, each for one thread."""

PARTS = 16
"""Steps of the work whose progress is told."""

AT_ONCE = 200_000
"""Most points whose work is one step: it takes less than a second."""

_Floats = npt.NDArray[np.float64]


class Cells(NamedTuple):
    """The cells of a cloud. Points in one smallest cube count once, as the first of them.

    Parameters
    ----------
    number
        Of each point among the distinct ones: shape (n,), int32.
    first
        The point that each distinct one is: shape (m,), int32.
    positions
        Of the distinct points, in units of the bulk's extent: shape (m, 3).
    unit
        That extent in the cloud's unit.
    keys
        Positions along the curve, ascending, and -1: shape (m + 1,), int64.
    levels
        Levels of the octree.
    table
        First distinct point of each cube of a coarser level, and the end.
    table_levels
        The level of the table.
    starts
        First distinct point of each cell, and the end: shape (cells + 1,).
    depths
        The level of each cell.
    """

    number: npt.NDArray[np.int32]
    first: npt.NDArray[np.int32]
    positions: _Floats
    unit: float
    keys: npt.NDArray[np.int64]
    levels: int
    table: npt.NDArray[np.int32]
    table_levels: int
    starts: npt.NDArray[np.int32]
    depths: npt.NDArray[np.int32]


def build_cells(positions: _Floats, curve: Curve | None = None) -> Cells:
    """Return the cells of a cloud.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite; n at least 1.
    curve
        The points along Morton's curve; None: they are sorted here.
    """
    positions = np.ascontiguousarray(positions, np.float64)
    if curve is None:
        curve = sort_along_curve(positions)
    count, levels = len(positions), curve.levels
    number = np.empty(count, np.int32)
    first = np.empty(count, np.int32)
    keys = np.empty(count + 1, np.int64)
    distinct = _find_distinct(curve.order, curve.keys, number, first, keys)
    keys[distinct] = -1  # ends every search
    first, keys = first[:distinct].copy(), keys[: distinct + 1].copy()
    scaled = np.empty((distinct, 3))
    _take_positions(positions, first, curve.low, curve.unit, scaled)
    table_levels = min(TABLE_LEVELS, levels)
    cubes = np.arange((1 << 3 * table_levels) + 1, dtype=np.int64)
    table = np.searchsorted(keys[:-1] >> 3 * (levels - table_levels), cubes).astype(np.int32)
    starts = np.empty(distinct + 1, np.int32)
    depths = np.empty(distinct, np.int32)
    cells = _cut_cells(keys, levels, starts, depths)
    return Cells(
        number,
        first,
        scaled,
        curve.unit,
        keys,
        levels,
        table,
        table_levels,
        starts[: cells + 1].copy(),
        depths[:cells].copy(),
    )


def parts_of(
    cells: Cells, progress: Callable[[float], None] | None = None
) -> Iterator[npt.NDArray[np.int64]]:
    """Yield the parts of the work: where each of a part's chunks begins among the cells.

    A part is done in parallel, a chunk by one thread. Chunks are the same on every machine, so that
    results do not depend on it.

    Parameters
    ----------
    cells
        The cells.
    progress
        Called after each part with the share of the work that is done. None: there is one part.
    """
    edges = np.linspace(0, len(cells.depths), CHUNKS + 1).astype(np.int64)
    parts = PARTS if progress is not None and len(cells.first) > AT_ONCE else 1
    size = CHUNKS // parts
    for part in range(parts):
        yield edges[part * size : (part + 1) * size + 1]
        if progress is not None:
            progress((part + 1) / parts)


def search_of(cells: Cells) -> tuple[Any, ...]:
    """Return what compiled code needs to find neighbourhoods, without the positions."""
    return (
        cells.keys, cells.levels, cells.table, cells.table_levels, cells.starts, cells.depths,
    )  # fmt: skip


@cached_njit()
def _find_distinct(order: Any, all_keys: Any, number: Any, first: Any, keys: Any) -> int:
    """Number the points by distinct keys; return how many there are."""
    distinct, last = 0, -1
    for i in range(len(order)):
        point, key = order[i], all_keys[i]
        if key != last:
            first[distinct], keys[distinct] = point, key
            distinct += 1
            last = key
        number[point] = distinct - 1
    return distinct


@cached_njit(parallel=True, error_model="numpy")
def _take_positions(positions: Any, first: Any, low: Any, unit: float, scaled: Any) -> None:
    """Copy the distinct points' positions, in units of the bulk's extent."""
    for i in nb.prange(len(first)):
        prefetch(positions, 24 * first[min(i + AHEAD, len(first) - 1)])
        for axis in range(3):
            scaled[i, axis] = (positions[first[i], axis] - low[axis]) / unit


@cached_njit()
def _cut_cells(keys: Any, levels: int, starts: Any, depths: Any) -> int:
    """Set the cells' starts and levels; return how many there are.

    The cell that starts at a point has the lowest level at which the point before lies in another
    cube, and the one ``CELL_POINTS`` further as well.
    """
    cells, at = 0, 0
    while at < (len(keys) - 1):
        level = 0
        if at > 0:
            level = common_levels(keys[at - 1] ^ keys[at], levels) + 1
        if at + CELL_POINTS < (len(keys) - 1):
            level = max(level, common_levels(keys[at] ^ keys[at + CELL_POINTS], levels) + 1)
        starts[cells], depths[cells] = at, level
        cells += 1
        shift = 3 * (levels - level)
        cube = keys[at] >> shift
        while at < (len(keys) - 1) and keys[at] >> shift == cube:
            at += 1
    starts[cells] = len(keys) - 1
    return cells
