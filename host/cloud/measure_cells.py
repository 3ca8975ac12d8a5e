"""The pass over a cloud's cells: one search of neighbours gives normals and closing radii."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

from .cell_normals import estimate_in_cell, new_workspace, take_around
from .cell_radii import close_in_cell
from .cells import Cells, parts_of, search_of
from .closing import COSINES, DIRECTIONS, SINES, Closing
from .neighbourhood import CANDIDATES, CUBE_POINTS, gather_candidates

__all__ = ["measure_cells"]

FEWEST = 12
"""Fewer points make no surface. Each is shown apart."""


def measure_cells(
    cells: Cells,
    normals: npt.NDArray[np.float32],
    needed: npt.NDArray[np.bool_],
    closing: Closing | None = None,
    *,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Set normals that are needed, and then closing radii, of a cloud's distinct points.

    Parameters
    ----------
    cells
        The cells of the cloud.
    normals
        Of the distinct points: shape (m, 3), float32. Those that are needed are set; closing radii
        take the others as they are.
    needed
        Shape (m,), bool.
    closing
        Set; None: no closing radii are measured.
    progress
        Called now and then with the share of the work that is done.
    """
    few = len(cells.first) < FEWEST
    radii, thin = closing or Closing(np.empty(0), np.empty(0, np.bool_))
    arrays = cells.positions, needed, normals, COSINES, SINES, radii, thin
    for cuts in parts_of(cells, progress):
        _measure(search_of(cells), cuts, few, closing is not None, *arrays)


@cached_njit(parallel=True, error_model="numpy")
def _measure(
    search: Any,
    cuts: Any,
    few: bool,
    closes: bool,
    positions: Any,
    needed: Any,
    normals: Any,
    cosines: Any,
    sines: Any,
    radii: Any,
    thin: Any,
) -> None:
    """Measure the cells of one part; see :func:`measure_cells`."""
    keys, levels, table, table_levels, starts, depths = search
    for chunk in nb.prange(len(cuts) - 1):
        space = new_workspace()
        found = space.found
        away = np.empty((3, CANDIDATES), np.float32)
        pull = np.empty((2, CANDIDATES), np.float32)
        most, sides = np.empty(DIRECTIONS, np.float32), np.empty((2, DIRECTIONS + 1), np.float32)
        for cell in range(cuts[chunk], cuts[chunk + 1]):
            start, stop, depth = starts[cell], starts[cell + 1], depths[cell]
            estimates = False
            for i in range(start, stop):
                estimates |= needed[i]
            if not (estimates or closes):
                continue
            count = gather_candidates(
                keys, levels, table, table_levels, start, depth, CUBE_POINTS, found
            )
            scale = float(1 << depth)
            if closes:
                take_around(positions, found, count, start, scale, away)
            if estimates:
                take_around(positions, found, count, start, scale, space.around)
                estimate_in_cell(
                    search, positions, start, stop, depth, needed, count, space, normals
                )
            if closes:
                close_in_cell(
                    positions, normals, start, stop, depth, few, away, count, cosines, sines,
                    pull, most, sides, radii, thin,
                )  # fmt: skip
