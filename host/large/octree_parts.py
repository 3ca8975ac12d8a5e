"""Cuts an octree into parts along a Morton curve, so that each part is a region of space.

The root's cube has 8^``LEVEL`` cells. A part is a range of their Morton codes. Of a node that is as
small as a cell, or whose cells are all in the range, the part has all points; of a larger node it
has the points that lie in the range's cells. So each point is in one part, whatever is rounded.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.files.copc import Octree

__all__ = ["LEVEL", "code_ranges", "codes_in_node", "cut_octree"]

LEVEL = 6
"""Level of the octree whose cubes are cells: 64 along an axis."""

_Ints = npt.NDArray[np.int64]


def code_ranges(nodes: npt.NDArray[Any]) -> tuple[_Ints, _Ints]:
    """Return the first code of each node's cells, and the one behind the last: shape (n,) each.

    A node that is smaller than a cell has the code of its cell.
    """
    level = nodes["level"].astype(np.int64)
    places = np.stack([nodes[axis] for axis in "xyz"], axis=1).astype(np.int64)
    up, down = np.maximum(LEVEL - level, 0), np.maximum(level - LEVEL, 0)
    first = _codes(places << up[:, np.newaxis] >> down[:, np.newaxis])
    return first, first + (np.int64(1) << 3 * up)


def codes_in_node(positions: npt.NDArray[np.float64], octree: Octree, node: Any) -> _Ints:
    """Return the codes of the cells in which points of a node lie: shape (n,).

    Points that lie outside of the node's cube, by rounding, have the code of its nearest cell.

    Parameters
    ----------
    positions
        Shape (n, 3): absolute.
    octree, node
        The octree, and the node as one of its entries, larger than a cell.
    """
    up = LEVEL - int(node["level"])
    least = np.array([int(node[axis]) << up for axis in "xyz"])
    places = np.floor((positions - octree.corner) * ((1 << LEVEL) / octree.side))
    return _codes(np.clip(places, least, least + (1 << up) - 1).astype(np.int64))


def cut_octree(nodes: npt.NDArray[Any], most: int) -> list[tuple[int, int]]:
    """Return ranges of codes that have all cells, each with about ``most`` points at most.

    Parameters
    ----------
    nodes
        The nodes that are read. The points of a large one count as spread evenly over its cells.
    most
        Points; the points of one cell stay together.
    """
    codes = 1 << 3 * LEVEL
    first, stop = code_ranges(nodes)
    steps = np.zeros(codes + 1)
    share = nodes["count"] / (stop - first)
    np.add.at(steps, first, share)
    np.add.at(steps, stop, -share)
    before = np.concatenate([[0.0], np.cumsum(np.cumsum(steps[:-1]))])
    parts = max(1, -(-int(nodes["count"].sum(dtype=np.int64)) // most))
    inner = np.searchsorted(before, before[-1] * np.arange(1, parts) / parts)
    cuts = np.unique(np.concatenate([[0], inner, [codes]])).tolist()
    return list(itertools.pairwise(cuts))


def _codes(places: _Ints) -> _Ints:
    """Return the Morton codes of places of level ``LEVEL``: shape (n,)."""
    codes = np.zeros(len(places), np.int64)
    for bit in range(LEVEL):
        for axis in range(3):
            codes |= (places[:, axis] >> bit & 1) << 3 * bit + axis
    return codes
