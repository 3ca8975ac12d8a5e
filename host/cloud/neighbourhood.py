"""The neighbourhood of a cell: the points of the 27 cubes of its size about it."""

from __future__ import annotations

from typing import Any

import numba as nb

from .curve import joined_bits, spread_bits

__all__ = ["CANDIDATES", "gather_candidates"]

CUBE_POINTS = 64
"""Most points that are taken of a cube, evenly along the curve. It bounds the time where a dense
spot lies beside a sparse one."""

CANDIDATES = 27 * CUBE_POINTS
"""Most points of a neighbourhood."""


@nb.njit(inline="always")
def _lower_bound(keys: Any, table: Any, shift: int, key: int) -> int:
    """Return the first point whose key is at least ``key``."""
    cube = key >> shift
    if cube >= len(table) - 1:
        return len(keys) - 1
    low, high = table[cube], table[cube + 1]
    while low < high:
        middle = (low + high) >> 1
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low


@nb.njit
def gather_candidates(
    keys: Any,
    levels: int,
    table: Any,
    table_levels: int,
    start: int,
    depth: int,
    cube_points: int,
    found: Any,
) -> int:
    """Set the distinct points of a cell's neighbourhood; return how many there are.

    Parameters
    ----------
    keys, levels, table, table_levels
        See :class:`Cells`.
    start, depth
        First point of the cell, and its level.
    cube_points
        Most points that are taken of a cube: at most ``CUBE_POINTS``.
    found
        Set: shape (``CANDIDATES``,).
    """
    shift, table_shift = 3 * (levels - depth), 3 * (levels - table_levels)
    cube = keys[start] >> shift
    x, y, z = joined_bits(cube), joined_bits(cube >> 1), joined_bits(cube >> 2)
    side = 1 << depth
    count = 0
    for c in range(max(z - 1, 0), min(z + 2, side)):
        for b in range(max(y - 1, 0), min(y + 2, side)):
            for a in range(max(x - 1, 0), min(x + 2, side)):
                key = spread_bits(a) | spread_bits(b) << 1 | spread_bits(c) << 2
                low = _lower_bound(keys, table, table_shift, key << shift)
                if keys[low] >> shift != key:
                    continue
                inside = 1
                while inside <= cube_points and keys[low + inside] >> shift == key:
                    inside += 1
                if inside > cube_points:  # seldom: the cube is far denser than the cell
                    inside = _lower_bound(keys, table, table_shift, key + 1 << shift) - low
                taken = min(inside, cube_points)
                for i in range(taken):
                    found[count] = low + i * inside // taken
                    count += 1
    return count
