"""Selection of the nodes of an octree that a view needs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.host.files.copc import Octree
from splatline.host.visibility.view import View

from .thin import Grid

__all__ = ["Chosen", "choose_nodes"]

SLACK = 1e-6
"""Share of a cube's side by which points may lie outside of it: coordinates are rounded."""

FINEST = 1.0
"""Cells between the points of a node, if the nodes below it are too fine."""

CORNERS = np.stack(np.meshgrid(*[(-SLACK, 1.0 + SLACK)] * 3), axis=-1).reshape(8, 3)


class Chosen(NamedTuple):
    """The nodes that a view needs, and why it does not need the others.

    Parameters
    ----------
    needed, outside, finer
        Which of the octree's nodes are needed, which the view does not see, and of which the
        points lie closer together than cells: shape (n,) each. A node is one of the three.
    """

    needed: npt.NDArray[np.bool_]
    outside: npt.NDArray[np.bool_]
    finer: npt.NDArray[np.bool_]


def choose_nodes(octree: Octree, view: View, origin: npt.NDArray[np.float64], grid: Grid) -> Chosen:
    """Return the nodes that a view needs.

    A node is outside if no point of its cube is in a cell of the grid, as one side of the view
    alone tells; so a few more are read. It is too fine if the points of the node above it lie no
    further apart than ``FINEST`` where its cube is nearest to the eye. All nodes below it are too
    fine then: they are as far away, or further.

    Parameters
    ----------
    octree
        The octree.
    view
        The view; its coordinates are relative to ``origin``.
    origin
        Shape (3,), float64.
    grid
        The view's cells.
    """
    corners, sides = octree.cubes()
    right, down = np.full((2, len(sides), 8), np.nan)
    ahead = np.empty_like(right)
    for k, corner in enumerate(CORNERS):
        seen = (corners + corner * sides[:, np.newaxis] - origin - view.eye) @ view.axes.T
        right[:, k], down[:, k], ahead[:, k] = seen.T
    nearest, farthest = ahead.min(axis=1), ahead.max(axis=1)
    outside = (farthest < view.near) | (nearest > grid.farthest)
    for across, middle, cells in zip(
        (right, down), view.middle, (grid.wide, grid.high), strict=True
    ):
        # The column of a point is middle + focal across / ahead, and ahead is above 0.
        first = view.focal * across + (middle + grid.beside) * ahead
        last = view.focal * across + (middle + grid.beside - cells / grid.cells) * ahead
        outside |= (first < 0.0).all(axis=1) | (last > 0.0).all(axis=1)
    pixels = view.focal / np.maximum(nearest, view.near)
    finer = ~outside & (2.0 * octree.spacings() * pixels * grid.cells <= FINEST)
    finer &= octree.nodes["level"] > 0
    return Chosen(~(outside | finer), outside, finer)
