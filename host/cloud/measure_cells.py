"""Passes over a cloud's cells: a search of neighbours gives normals and closing radii."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.progress import part_of
from splatline.host.compiled_cache import cached_njit

from .cell_normals import GROWTHS, estimate_in_cell, new_workspace, take_around
from .cell_radii import close_in_cell
from .cells import Cells, parts_of, search_of
from .closing import MOST_SIDES, Closing
from .neighbourhood import CANDIDATES, CUBE_POINTS, gather_candidates
from .smooth_normals import is_noisy, smooth_in_cell, trust_in

__all__ = ["measure_cells"]

SAMPLED = 512
"""Cells that tell whether a cloud is noisy."""

MANY = 1000
"""Fewer points do not tell noise from the shape of a surface."""

FEWEST = 12
"""Fewer points make no surface. Each is shown apart."""


def measure_cells(
    cells: Cells,
    normals: npt.NDArray[np.float32],
    needed: npt.NDArray[np.bool_],
    closing: Closing | None = None,
    *,
    signed: bool = False,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Set normals that are needed, and then closing radii, of a cloud's distinct points.

    Normals of a noisy cloud are smoothed in a second pass over the cells, which also finds the
    closing radii. What a sample of the cells tells decides for the whole cloud.

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
    signed
        Whether all normals are given and tell the outer side of a surface.
    progress
        Called now and then with the share of the work that is done.
    """
    if not (needed.any() and _has_noise(cells)):
        _pass(cells, normals, needed, closing=closing, signed=signed, progress=progress)
        return
    rough, shares = np.zeros_like(normals), np.zeros(len(needed), np.float32)
    # Those that are not needed count in the means of others.
    _pass(cells, rough, np.ones_like(needed), shares, progress=part_of(progress, 0.0, 0.5))
    told = part_of(progress, 0.5, 1.0)
    _pass(cells, normals, needed, trust_in(shares), rough, closing, progress=told)


def _has_noise(cells: Cells) -> bool:
    """Return whether a cloud is noisy, from a sample of its cells.

    Their neighbourhoods do not grow, as a larger one of a noisy plane is flat.
    """
    if len(cells.first) < MANY:
        return False
    chosen = np.zeros(len(cells.depths), np.bool_)
    chosen[:: -(-len(chosen) // SAMPLED)] = True
    sampled = np.repeat(chosen, np.diff(cells.starts))
    shares = np.zeros(len(sampled), np.float32)
    _pass(cells, np.zeros((len(sampled), 3), np.float32), sampled, shares, growths=0)
    return is_noisy(shares[sampled])


def _pass(
    cells: Cells,
    normals: npt.NDArray[np.float32],
    needed: npt.NDArray[np.bool_],
    shares: npt.NDArray[np.float32] | None = None,
    rough: npt.NDArray[np.float32] | None = None,
    closing: Closing | None = None,
    *,
    signed: bool = False,
    growths: int = GROWTHS,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Pass over the cells: estimate normals, or smooth ``rough`` ones, and find closing radii.

    Parameters
    ----------
    shares
        Shape (m,), float32. An estimate sets them to shares of thickness; for smoothing they tell
        how much each rough normal counts. None: they are not kept.
    signed
        See :func:`measure_cells`.
    """
    few = len(cells.first) < FEWEST
    radii, thin = closing or Closing(np.empty(0), np.empty(0, np.bool_))
    if shares is None:
        shares = np.empty(len(needed), np.float32)
    smooths = rough is not None
    before = np.empty((0, 3), np.float32) if rough is None else rough
    arrays = cells.positions, needed, normals, before, shares, radii, thin
    for cuts in parts_of(cells, progress):
        ways = few, closing is not None, signed, smooths
        _measure(search_of(cells), cuts, *ways, growths, *arrays)


@cached_njit(parallel=True, error_model="numpy")
def _measure(
    search: Any,
    cuts: Any,
    few: bool,
    closes: bool,
    signed: bool,
    smooths: bool,
    growths: int,
    positions: Any,
    needed: Any,
    normals: Any,
    rough: Any,
    shares: Any,
    radii: Any,
    thin: Any,
) -> None:
    """Measure the cells of one part; see :func:`_pass`."""
    keys, levels, table, table_levels, starts, depths = search
    for chunk in nb.prange(len(cuts) - 1):
        space = new_workspace()
        found = space.found
        near, weights = np.empty(CANDIDATES, np.int64), np.empty(CANDIDATES, np.float32)
        away = np.empty((3, CANDIDATES), np.float32)
        facing = np.empty((3, CANDIDATES), np.float32)
        pull = np.empty((2, CANDIDATES), np.float32)
        waiting = np.empty(MOST_SIDES + 1, np.int64)
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
            if closes or smooths:
                take_around(positions, found, count, start, scale, away)
            if estimates and smooths:
                smooth_in_cell(
                    start, stop, needed, away, count, space, rough, shares, weights, near, normals
                )
            elif estimates:
                take_around(positions, found, count, start, scale, space.around)
                estimate_in_cell(
                    search, positions, start, stop, depth, needed, count, growths, space, normals,
                    shares,
                )  # fmt: skip
            if signed:
                for c in range(count):
                    for axis in range(3):
                        facing[axis, c] = normals[found[c], axis]
            if closes:
                close_in_cell(
                    positions, normals, start, stop, depth, few, away, facing, count, signed,
                    pull, waiting, radii, thin,
                )  # fmt: skip
