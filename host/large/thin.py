"""Thins points to cells that are as large as a pixel, as a view sees them."""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba.extending import intrinsic

from splatline.contract.errors import InputError
from splatline.host.compiled_cache import cached_njit
from splatline.host.visibility.cull import Camera, from_eye
from splatline.host.visibility.view import View

from .cells import CellTable

__all__ = ["CELLS", "Grid", "Thinned", "Thinner", "coarser", "grid_of"]

CELLS = 1.0
"""Cells of a pixel, along a line and from line to line: of smaller ones the picture is further from
the truth, as points of noise are not averaged (decision 0078)."""

PLACE_BITS, DEPTH_BITS = 18, 26
"""Bits of a cell's column and line, and of its depth, in its key; a key has 63."""

MOST = (1 << PLACE_BITS) - 1
"""Most cells along a line."""

MANTISSA = 52
"""Bits of a float64's fraction."""

LARGEST = float(1 << 40)
"""Whole numbers beyond this are no values; sums of 2^22 of them fit int64."""

BESIDE = 0.125
"""Share of the image's longer side by which points count that lie beside the image. They shape the
discs at its border."""

_Floats = npt.NDArray[np.float64]


class Grid(NamedTuple):
    """The cells of a view.

    Parameters
    ----------
    cells
        Cells of a pixel, along a line and from line to line.
    beside
        Pixels around the image in which cells count too.
    wide, high
        Cells along a line, and lines of cells.
    shift
        Lowest bits of a distance's float64 that do not tell its cell.
    nearest
        Number of the first cell of distances.
    farthest
        Greatest distance along the view at which points count.
    """

    cells: float
    beside: float
    wide: int
    high: int
    shift: int
    nearest: int
    farthest: float


def grid_of(view: View, cells: float, farthest: float) -> Grid:
    """Return the cells of a view, each about as deep as it is wide.

    A cell holds the distances along the view whose float64 have the same highest bits. So cells
    grow with the distance, as what a pixel covers does, and are between half as deep and as deep as
    they are wide.

    Parameters
    ----------
    view
        The view.
    cells
        Cells of a pixel, along a line and from line to line; a power of 2.
    farthest
        Greatest distance along the view at which points count.
    """
    beside = BESIDE * max(view.width, view.height)
    fine = math.ceil(math.log2(max(view.focal * cells, 1.0)))
    shift = MANTISSA - min(fine, DEPTH_BITS - 6)
    (bits,) = np.array([view.near]).view(np.int64).tolist()
    wide, high = (math.ceil((side + 2.0 * beside) * cells) for side in (view.width, view.height))
    if max(wide, high) > MOST:
        raise InputError(f"an image of {view.width}x{view.height} has too many cells")
    return Grid(cells, beside, wide, high, shift, bits >> shift, farthest)


def coarser(grid: Grid, keys: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return the keys of cells in a grid of cells twice as large, which hold whole cells."""
    number = keys - 1
    line = (number & MOST) >> 1
    column = (number >> PLACE_BITS & MOST) >> 1
    depth = (number >> 2 * PLACE_BITS) + grid.nearest
    depth = (depth >> 1) - (grid.nearest >> 1)
    merged: npt.NDArray[np.int64] = depth << 2 * PLACE_BITS | column << PLACE_BITS | line
    return merged + 1


class Thinned(NamedTuple):
    """The cells that hold points, by ascending key.

    Parameters
    ----------
    positions
        The mean position of each one's points: shape (cells, 3), float64.
    values
        The means of their other values: shape (cells, values), float64.
    points
        How many points each holds: shape (cells,), int64.
    """

    positions: _Floats
    values: _Floats
    points: npt.NDArray[np.int64]


class Thinner:
    """Gathers points in the cells of a view, in any order and in any pieces.

    If there are more than ``most`` cells, they are merged to cells twice as large, each of which
    holds whole ones. So the result depends on the points alone.

    Parameters
    ----------
    view
        The view; its coordinates are relative to ``origin``.
    origin
        Shape (3,), float64.
    farthest
        Greatest distance along the view at which points count. Positions are rounded to 2^-30 of
        it.
    steps
        To what each of a point's other values is rounded: shape (values,), float64, above 0.
    cells
        Cells of a pixel, along a line and from line to line; a power of 2.
    most
        Most cells that are kept.

    Attributes
    ----------
    points, outside
        Points that were added, and those of them that no cell holds.
    grid
        The cells.
    """

    def __init__(
        self,
        view: View,
        origin: _Floats,
        farthest: float,
        steps: _Floats,
        cells: float,
        most: int,
    ) -> None:
        self.grid = grid_of(view, cells, farthest)
        self.points = self.outside = 0
        self._table = CellTable(3 + len(steps))
        self._most = most
        self._camera = Camera.of(view)
        self._origin = origin
        self._steps = steps
        # Beside the view's axis a point in the image may lie further than along it.
        reach = farthest * (1.0 + max(view.width, view.height) / view.focal)
        self._step = math.ldexp(1.0, math.frexp(max(reach, 1e-290))[1] - 31)

    def __len__(self) -> int:
        """Return the number of cells that hold points."""
        return len(self._table)

    def add(self, positions: _Floats, values: npt.NDArray[Any]) -> None:
        """Add points.

        Parameters
        ----------
        positions
            Shape (n, 3), float64: absolute. Those that are not finite count as outside.
        values
            Shape (n, values), any real type. Those that are not finite count as 0.
        """
        keys = np.empty(len(positions), np.int64)
        whole = np.empty((len(positions), 3 + values.shape[1]), np.int64)
        _keys(positions, self._origin, self._camera, self.grid, 1.0 / self._step, keys, whole)
        _round(values, 1.0 / self._steps, whole)
        self._table.add(keys, None, whole)
        self.points += len(keys)
        self.outside += len(keys) - int(np.count_nonzero(keys))
        while len(self._table) > self._most and min(self.grid.wide, self.grid.high) > 1:
            self._merge()

    def _merge(self) -> None:
        """Merge cells to cells twice as large."""
        grid = self.grid
        self._table.merge_cells(functools.partial(coarser, grid))
        self.grid = grid._replace(
            cells=0.5 * grid.cells,
            wide=grid.wide + 1 >> 1,
            high=grid.high + 1 >> 1,
            shift=grid.shift + 1,
            nearest=grid.nearest >> 1,
        )

    def result(self) -> Thinned:
        """Return the cells, and forget them."""
        means, points = self._table.means()
        self._table = CellTable(len(means))
        positions = np.ascontiguousarray(means[:3].T)
        positions *= self._step
        positions += self._origin
        return Thinned(positions, means[3:].T * self._steps, points)


@intrinsic
def _bits(_: Any, number: Any) -> Any:
    """Return a float64's bits."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.IntType(64))

    return nb.int64(nb.float64), code


@cached_njit(parallel=True, error_model="numpy")
def _keys(
    positions: Any, origin: Any, camera: Any, grid: Any, inverse: float, keys: Any, whole: Any
) -> None:
    """Set each point's cell, 0 if none holds it, and its coordinates as whole numbers.

    Parameters
    ----------
    positions, origin
        As for :class:`Thinner`.
    camera, grid
        The view and its cells.
    inverse
        1 over what coordinates are rounded to.
    keys
        Set: shape (n,), int64.
    whole
        Its first three columns are set: shape (n, 3 or more), int64.
    """
    for i in nb.prange(len(positions)):
        x = positions[i, 0] - origin[0]
        y = positions[i, 1] - origin[1]
        z = positions[i, 2] - origin[2]
        right, down, ahead = from_eye(camera, x, y, z)
        keys[i] = 0
        if not camera.near <= ahead <= grid.farthest:
            continue
        scale = camera.focal / ahead
        column = (camera.middle_x + scale * right + grid.beside) * grid.cells
        line = (camera.middle_y + scale * down + grid.beside) * grid.cells
        if not (0.0 <= column < grid.wide and 0.0 <= line < grid.high):
            continue
        depth = min((_bits(ahead) >> grid.shift) - grid.nearest, (1 << DEPTH_BITS) - 1)
        place = np.int64(column) << PLACE_BITS | np.int64(line)
        keys[i] = 1 + (depth << 2 * PLACE_BITS | place)
        whole[i, 0] = math.floor(x * inverse + 0.5)
        whole[i, 1] = math.floor(y * inverse + 0.5)
        whole[i, 2] = math.floor(z * inverse + 0.5)


@cached_njit(parallel=True, error_model="numpy")
def _round(values: Any, inverse: Any, whole: Any) -> None:
    """Set a point's other values as whole numbers, behind its coordinates."""
    for i in nb.prange(len(values)):
        for k in range(values.shape[1]):
            value = float(values[i, k]) * inverse[k]
            value = value if abs(value) < LARGEST else 0.0  # NaN too
            whole[i, 3 + k] = math.floor(value + 0.5)
