"""A table of cells that hold points: a hash table of whole numbers, so that order plays no part.

A cell is about as large as a pixel where it lies. Its row has its key, its points, and the sums
of their values. Sums of whole numbers are exact, so points may be added in any order, and tables
may be added to tables.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

__all__ = ["KEY", "POINTS", "VALUES", "CellTable"]

KEY, POINTS, VALUES = 0, 1, 2
"""Columns of a row: the cell's key, its points, and the first of the sums."""

PARTS = 4
"""Parts of the table, which are filled in parallel."""

PART_BITS = 2

FULL = 0.8
"""Share of a part's rows beyond which the table grows."""

GROWTH = 1.6

LEAST = 1 << 15
"""Rows of a part at first."""

FIBONACCI = np.uint64(0x9E3779B97F4A7C15)
"""2^64 over the golden ratio."""

_Ints = npt.NDArray[np.int64]
_Floats = npt.NDArray[np.float64]


class CellTable:
    """Cells by their keys.

    Parameters
    ----------
    values
        Values of a point, which are summed.
    """

    def __init__(self, values: int) -> None:
        self._rows = np.zeros((PARTS, LEAST, VALUES + values), np.int64)
        self._fill = np.zeros(PARTS, np.int64)

    def __len__(self) -> int:
        """Return the number of cells."""
        return int(self._fill.sum())

    def add(self, keys: _Ints, points: _Ints | None, values: _Ints) -> None:
        """Add points, or the rows of another table.

        Parameters
        ----------
        keys
            Each one's cell: shape (n,), int64; 0: it is left out.
        points
            How many points each row stands for: shape (n,), int64; None: one each.
        values
            Their sums: shape (n, values), int64.
        """
        if points is None:
            points = np.empty(0, np.int64)
        begins = np.zeros(PARTS, np.int64)
        while True:
            _add(keys, points, values, begins, self._rows, self._fill)
            if (begins == len(keys)).all():
                return
            self._grow()

    def means(self) -> tuple[_Floats, _Ints]:
        """Return the means of the values of each cell, by ascending key, and its points.

        Returns
        -------
        means
            Shape (values, cells), float64.
        points
            Shape (cells,), int64.
        """
        table = self._rows.reshape(-1, self._rows.shape[2])
        used = np.flatnonzero(table[:, KEY])
        used = used[np.argsort(table[used, KEY])]
        means = np.empty((table.shape[1] - VALUES, len(used)))
        points = np.empty(len(used), np.int64)
        _means(table, used, means, points)
        return means, points

    def merge_cells(self, coarser: Callable[[_Ints], _Ints]) -> None:
        """Merge cells: ``coarser`` returns the new keys of some keys."""
        old = self._rows
        self._rows, self._fill = np.zeros_like(old), np.zeros(PARTS, np.int64)
        for part in old:
            rows = part[part[:, KEY] != 0]
            rows[:, KEY] = coarser(rows[:, KEY])
            self._insert_all(rows)

    def _grow(self) -> None:
        """Make room for more cells."""
        old = self._rows
        shape = PARTS, int(GROWTH * old.shape[1]), old.shape[2]
        self._rows, self._fill = np.zeros(shape, np.int64), np.zeros(PARTS, np.int64)
        for part in old:
            self._insert_all(part[part[:, KEY] != 0])

    def _insert_all(self, rows: _Ints) -> None:
        """Add the rows of another table, for which there is room."""
        keys, points = rows[:, KEY].copy(), rows[:, POINTS].copy()
        self.add(keys, points, np.ascontiguousarray(rows[:, VALUES:]))


@cached_njit(parallel=True)
def _add(keys: Any, points: Any, values: Any, begins: Any, rows: Any, fill: Any) -> None:
    """Add points to the parts of a table, each up to the point for which it has no room.

    Parameters
    ----------
    keys, points, values
        See :meth:`CellTable.add`; without ``points`` each is one.
    begins
        The first point that each part looks at; set to the one it did not take, or the end.
    rows, fill
        The table, and the cells of each part; changed.
    """
    length = rows.shape[1]
    most = int(FULL * length)
    for part in nb.prange(PARTS):
        table = rows[part]
        cells = fill[part]
        i = begins[part]
        while i < len(keys):
            hashed = np.uint64(keys[i]) * FIBONACCI
            if keys[i] != 0 and np.int64(hashed >> np.uint64(64 - PART_BITS)) == part:
                # The next 32 bits, as a share of the length.
                share = np.int64(hashed << np.uint64(PART_BITS) >> np.uint64(32))
                slot = share * length >> 32
                while table[slot, KEY] != keys[i] and table[slot, KEY] != 0:
                    slot = slot + 1 if slot + 1 < length else 0
                if table[slot, KEY] == 0:
                    if cells >= most:
                        break
                    table[slot, KEY] = keys[i]
                    cells += 1
                table[slot, POINTS] += points[i] if len(points) else 1
                for k in range(values.shape[1]):
                    table[slot, VALUES + k] += values[i, k]
            i += 1
        fill[part] = cells
        begins[part] = i


@cached_njit(parallel=True)
def _means(table: Any, used: Any, means: Any, points: Any) -> None:
    """Set the means of the rows that are used, and their points."""
    for i in nb.prange(len(used)):
        row = table[used[i]]
        points[i] = row[POINTS]
        for k in range(len(means)):
            means[k, i] = row[VALUES + k] / row[POINTS]
