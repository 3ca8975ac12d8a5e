"""Reads a part of a large cloud, thinned on the way to what the view can show."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.files.assemble import assemble_cloud
from splatline.host.files.columns import Columns

from .nodes import choose_nodes
from .pieces import Colouring, colours_of
from .plan import Part, Plan
from .thin import Thinner

__all__ = ["CELLS", "FIXED_BYTES", "POINT_BYTES", "cells_of_memory", "read_part"]

CELLS = 1.0
"""Cells of a pixel, along a line and from line to line: of smaller ones the picture is further from
the truth, as points of noise are not averaged (decision 0078)."""

CELL_BYTES = 250
"""Most memory that a cell takes: as a point of a cloud, while its disc is measured."""

POINT_BYTES = 250
"""Most memory that a point takes of a cloud that is read at once."""

FIXED_BYTES = 500 << 20
"""Memory that is taken whatever the cloud: programs, a piece of a file, and pictures."""

FEWEST_CELLS = 1 << 16

NORMAL_STEP = 2.0**-20


def cells_of_memory(memory: int) -> int:
    """Return the most cells that a part may have, given bytes of memory."""
    return max(FEWEST_CELLS, (memory - FIXED_BYTES) // CELL_BYTES)


def read_part(
    plan: Plan,
    part: Part,
    memory: int,
    *,
    progress: Callable[[str, float], None] | None = None,
) -> Cloud | None:
    """Return a part's points, thinned to the cells of the view; None if it shows none of them.

    Points of a cell become one, at their mean position, with the mean of their colours and normals.
    A cell is a pixel wide, or as many times twice as wide as the memory asks for. The result
    depends neither on the order of the part's points nor on the pieces in which they are read. Of a
    COPC file only the nodes that the view needs are read (see ``choose_nodes``).

    Parameters
    ----------
    plan, part
        The part of the plan.
    memory
        Bytes that may be used.
    progress
        Called now and then with a stage, ``read`` or ``normals``, and the share of it that is done.

    Returns
    -------
    Cloud
        Its positions are relative to the plan's origin. ``dropped`` has the points left out, by
        reason: ``outside`` of the view, and ``finer``, those that other points stand for.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    file, colouring = plan.files[part.file], plan.colourings[part.file]
    steps = np.concatenate([np.ones(3), np.full(3 * colouring.normals, NORMAL_STEP)])
    thinner = Thinner(plan.view, plan.origin, plan.farthest, steps, CELLS, cells_of_memory(memory))
    told = None if progress is None else lambda share: progress("read", share)
    columns = chosen = None
    if file.octree is not None:
        chosen = choose_nodes(file.octree, plan.view, plan.origin, thinner.grid)
    dropped: dict[str, int] = {}
    nodes = None if chosen is None else chosen.nodes
    for columns in file.pieces(part.first, part.stop, told, nodes):
        _add(thinner, columns, colouring)
        for reason, number in columns.dropped.items():
            dropped[reason] = dropped.get(reason, 0) + number
    if columns is None or not len(thinner):
        return None
    cells = thinner.grid.cells
    dropped |= {
        "outside": thinner.outside,
        "finer": thinner.points - thinner.outside - len(thinner),
    }
    if chosen is not None:
        dropped["outside"] += chosen.outside
        dropped["finer"] += chosen.finer
    thinned = thinner.result()
    return assemble_cloud(
        Columns(
            thinned.positions,
            thinned.values[:, 3:] if colouring.normals else None,
            np.rint(thinned.values[:, :3]).astype(np.uint8),
            columns.used,
            columns.ignored,
            (*columns.notes, *_notes(cells)),
            dropped,
            facts=columns.facts,
        ),
        file.path.stem,
        origin=plan.origin,
        progress=None if progress is None else lambda share: progress("normals", share),
    )


def _add(thinner: Thinner, columns: Columns, colouring: Colouring) -> None:
    """Add a piece of a file."""
    values: npt.NDArray[Any] = colours_of(columns, colouring)
    if colouring.normals:
        assert columns.normals is not None
        values = np.concatenate([values, columns.normals.astype(np.float64)], axis=1)
    positions = np.ascontiguousarray(columns.positions, np.float64)
    thinner.add(positions, np.ascontiguousarray(values))


def _notes(cells: float) -> tuple[str, ...]:
    """Return what a person should know about cells that are wider than usual."""
    if cells >= CELLS:
        return ()
    return (f"points of {1 / cells:g} pixels are drawn as one, to save memory; see --memory",)
