"""The radii of discs that close a surface, from the spacing of the points within it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.compiled_cache import cached_njit

from .cells import Cells, build_cells, parts_of
from .closing import Closing
from .cloud import Cloud
from .measure_cells import measure_cells
from .prefetch import AHEAD, prefetch

__all__ = ["Discs", "closing_radii", "measure_discs", "splat_radii"]

COVER = 1.25
"""Radius of a disc for a closing radius of 1. Neighbours lie off the disc's plane, so that discs of
the closing radius itself leave gaps where a surface bends or is noisy. Smaller ones leave more
holes, larger ones blur small relief (decision 0064)."""

MOST_UNEVEN = 3.0
"""A closing radius is at most this many times the median about it."""

AROUND = 32
"""Points before and after a cell along the curve, every fourth of which counts for that median."""

SINGLE = 0.01
"""Closing radius of a cloud whose points are all at one position."""

_Floats = npt.NDArray[np.float64]


class Discs(NamedTuple):
    """The discs of a cloud.

    Parameters
    ----------
    radii
        In the cloud's unit: shape (n,), float64, above 0.
    thin
        Which points have no gap about them that a surface would have, as on a curve or alone: shape
        (n,), bool. Such a point is drawn as one pixel where its disc covers no pixel's centre.
    cover
        How many times as large the discs are as those that just close the surface on a plane: 1 if
        their sizes were given.
    """

    radii: _Floats
    thin: npt.NDArray[np.bool_]
    cover: float = 1.0

    def drawn(self, *, close_specks: bool) -> Discs:
        """Return the discs as they are drawn: none is trimmed if specks stay open; see ``trim``."""
        return self if close_specks else self._replace(cover=1.0)


def splat_radii(
    cloud: Cloud, size: float | None = None, *, progress: Callable[[float], None] | None = None
) -> _Floats:
    """Return the radius of each point's disc; see :func:`measure_discs`."""
    return measure_discs(cloud, size, progress=progress).radii


def measure_discs(
    cloud: Cloud, size: float | None = None, *, progress: Callable[[float], None] | None = None
) -> Discs:
    """Return the discs of a cloud.

    Parameters
    ----------
    cloud
        The points; at least one.
    size
        Diameter of all discs, in the cloud's unit. None: the discs close the surface: each is
        ``COVER`` times as large as its closing radius (see :func:`closing_radii`). A cloud's own
        radii count if at least half of them are as large as that; else none is smaller.
    progress
        Called now and then with the share of the work that is done.

    Raises
    ------
    InputError
        If ``size`` is not a finite number above 0.
    """
    if size is None:
        signed = not cloud.two_sided.any()
        radii, thin, _ = _close(cloud.cells, cloud.normals, cloud.closing, signed, progress)
        radii *= COVER
        return Discs(radii, thin, COVER) if cloud.radii is None else _own(cloud.radii, radii, thin)
    if not (math.isfinite(size) and size > 0.0):
        raise InputError(f"the splat size must be above 0, not {size:g}")
    return Discs(np.full(len(cloud), 0.5 * size), np.zeros(len(cloud), np.bool_))


def _own(own: _Floats, closing: _Floats, thin: npt.NDArray[np.bool_]) -> Discs:
    """Return a cloud's own discs, none smaller than one that closes the surface if most are."""
    small = own < closing
    if 2 * np.count_nonzero(small) <= len(own):
        return Discs(own, np.zeros(len(own), np.bool_))
    return Discs(np.where(small, closing, own), thin & small)


def closing_radii(
    positions: _Floats,
    normals: npt.NDArray[np.float32],
    *,
    progress: Callable[[float], None] | None = None,
) -> _Floats:
    """Return the radii at which discs in the points' tangent planes just close the surface.

    In the tangent plane of a point, the middles of the gaps between it and its neighbours are the
    corners of its Voronoi region. Its disc must reach the furthest of them
    (:mod:`splatline.host.cloud.closing`). Density plays no part, so duplicates and lines of a
    scanner do not make discs too small. A disc at the border of a surface closes gaps on its inner
    side alone. Points in one smallest cube of the octree count once. A radius is at most
    ``MOST_UNEVEN`` times the median about the point, so that a stray point stays small.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite; n at least 1.
    normals
        Shape (n, 3), float32, of unit length.
    progress
        Called now and then with the share of the work that is done.

    Returns
    -------
    ndarray
        Shape (n,), float64, above 0: ``SINGLE`` if all points are at one position.
    """
    return _close(build_cells(positions), normals, None, False, progress).radii


def _close(
    cells: Cells,
    normals: npt.NDArray[np.float32],
    closing: Closing | None,
    signed: bool,
    progress: Callable[[float], None] | None,
) -> Discs:
    """Return the discs that just close a surface; see :func:`closing_radii`."""
    count = len(cells.number)
    if len(cells.first) == 1:
        return Discs(np.full(count, SINGLE), np.ones(count, np.bool_))
    if closing is None:
        closing = Closing.empty(len(cells.first))
        own = np.empty((len(cells.first), 3), np.float32)
        _take_normals(np.ascontiguousarray(normals), cells.first, own)
        none = np.zeros(len(own), np.bool_)
        measure_cells(cells, own, none, closing, signed=signed, progress=progress)
    raw, thin = closing
    even, alone = np.empty_like(raw), np.empty_like(thin)
    for cuts in parts_of(cells):
        _even_out(cells.starts, cuts, raw, thin, even, alone)
    radii = np.empty(count)
    _spread_out(even, cells.number, cells.unit, radii)
    return Discs(radii, alone[cells.number])


@cached_njit(parallel=True, error_model="numpy")
def _take_normals(normals: Any, first: Any, own: Any) -> None:
    """Copy the distinct points' normals."""
    for i in nb.prange(len(first)):
        prefetch(normals, 12 * first[min(i + AHEAD, len(first) - 1)])
        for axis in range(3):
            own[i, axis] = normals[first[i], axis]


@cached_njit(parallel=True, error_model="numpy")
def _even_out(starts: Any, cuts: Any, raw: Any, thin: Any, even: Any, alone: Any) -> None:
    """Limit each radius by the median of those about its cell, along the curve.

    A thin point among points of a surface belongs to the surface, as a chance of its sampling.
    """
    for chunk in nb.prange(len(cuts) - 1):
        for cell in range(cuts[chunk], cuts[chunk + 1]):
            start, stop = starts[cell], starts[cell + 1]
            first, last = max(start - AROUND, 0), min(stop + AROUND, len(raw))
            share = 0
            for i in range(first, last):
                share += thin[i]
            is_surface = 2 * share < last - first
            most = raw[start]
            for i in range(start + 1, stop):
                most = max(most, raw[i])
            # Sorting takes time. Where more than half are large enough, so is the median.
            enough, count = 0, 0
            for i in range(first, last, 4):
                enough += MOST_UNEVEN * raw[i] >= most
                count += 1
            limit = most
            if 2 * enough <= count + 1:
                limit = MOST_UNEVEN * _median(raw, first, last)
            for i in range(start, stop):
                even[i] = min(raw[i], limit)
                alone[i] = thin[i] and not is_surface


@nb.njit
def _median(values: Any, first: int, last: int) -> float:
    """Return the median of every fourth value. Numba takes seconds to compile numpy's."""
    ordered = np.empty((last - first + 3) // 4)
    for k in range(len(ordered)):
        value, at = values[first + 4 * k], k
        while at > 0 and value < ordered[at - 1]:
            ordered[at] = ordered[at - 1]
            at -= 1
        ordered[at] = value
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else 0.5 * (ordered[half - 1] + ordered[half])


@cached_njit(parallel=True, error_model="numpy")
def _spread_out(even: Any, number: Any, unit: float, radii: Any) -> None:
    """Set every point's radius in the cloud's unit."""
    for i in nb.prange(len(radii)):
        prefetch(even, 8 * number[min(i + AHEAD, len(number) - 1)])
        radii[i] = even[number[i]] * unit
