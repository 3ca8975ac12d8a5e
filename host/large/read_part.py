"""Reads a part of a large cloud, thinned on the way to what the view can show."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.files.assemble import assemble_cloud
from splatline.host.files.columns import Columns
from splatline.host.files.copc import Octree
from splatline.host.files.source import usual_up

from .memory import FIXED_BYTES
from .nodes import choose_nodes
from .octree_parts import code_ranges, codes_in_node
from .pieces import Colouring, PieceFile, colours_of, rows_of
from .plan import Part, Plan
from .thin import CELLS, Grid, Thinner

__all__ = ["PartCloud", "cells_of_memory", "read_part"]

CELL_BYTES = 250
"""Most memory that a cell takes: as a point of a cloud, while its disc is measured."""

FEWEST_CELLS = 1 << 16

NORMAL_STEP = 2.0**-20


def cells_of_memory(memory: int) -> int:
    """Return the most cells that a part may have, given bytes of memory."""
    return max(FEWEST_CELLS, (memory - FIXED_BYTES) // CELL_BYTES)


class PartCloud(NamedTuple):
    """The points that were read of a part.

    Parameters
    ----------
    cloud
        The points, thinned to the cells of the view; None if it shows none of them. Positions are
        relative to the plan's origin.
    dropped
        Points left out, by reason: ``outside`` of the view, and ``finer``, those that other points
        stand for.
    """

    cloud: Cloud | None
    dropped: dict[str, int]


def read_part(
    plan: Plan,
    part: Part,
    memory: int,
    *,
    progress: Callable[[str, float], None] | None = None,
) -> PartCloud:
    """Read a part's points, thinned to the cells of the view.

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

    Raises
    ------
    InputError
        If the file is damaged.
    """
    file, colouring = plan.files[part.file], plan.colourings[part.file]
    steps = np.concatenate([np.ones(3), np.full(3 * colouring.normals, NORMAL_STEP)])
    thinner = Thinner(plan.view, plan.origin, plan.farthest, steps, CELLS, cells_of_memory(memory))
    told = None if progress is None else lambda share: progress("read", share)
    columns = None
    dropped: Counter[str] = Counter()
    if file.octree is None:
        pieces = file.pieces(part.first, part.stop, told)
    else:
        pieces = _pieces_of_nodes(plan, part, file, file.octree, thinner.grid, dropped, told)
    for columns in pieces:
        _add(thinner, columns, colouring)
        dropped.update(columns.dropped)
    dropped["outside"] += thinner.outside
    dropped["finer"] += thinner.points - thinner.outside - len(thinner)
    if columns is None or not len(thinner):
        return PartCloud(None, dict(dropped))
    cells = thinner.grid.cells
    thinned = thinner.result()
    cloud = assemble_cloud(
        Columns(
            thinned.positions,
            thinned.values[:, 3:] if colouring.normals else None,
            np.rint(thinned.values[:, :3]).astype(np.uint8),
            columns.used,
            columns.ignored,
            (*columns.notes, *_notes(cells)),
            dict(dropped),
            facts=columns.facts,
        ),
        file.path.stem,
        origin=plan.origin,
        up=usual_up(file.path),
        progress=None if progress is None else lambda share: progress("normals", share),
    )
    return PartCloud(cloud, cloud.dropped)


def _pieces_of_nodes(
    plan: Plan,
    part: Part,
    file: PieceFile,
    octree: Octree,
    grid: Grid,
    dropped: Counter[str],
    told: Callable[[float], None] | None,
) -> Iterator[Columns]:
    """Yield the points of a part of an octree, of the nodes that the view needs.

    Nodes that it does not need are added to ``dropped`` by the part that has their first code.
    """
    chosen = choose_nodes(octree, plan.view, plan.origin, grid)
    nodes, counts = octree.nodes, octree.nodes["count"].astype(np.int64)
    first, stop = code_ranges(nodes)
    end = np.inf if part.stop is None else part.stop
    counted = (part.first <= first) & (first < end)
    for reason in ("outside", "finer"):
        dropped[reason] += int(counts[counted & getattr(chosen, reason)].sum())
    whole = counted & (stop <= end)
    if (chosen.needed & whole).any():
        yield from file.pieces(progress=told, nodes=nodes[chosen.needed & whole])
    shared = chosen.needed & ~whole & (first < end) & (part.first < stop)
    for at in np.flatnonzero(shared).tolist():
        for columns in file.pieces(nodes=nodes[at : at + 1]):
            codes = codes_in_node(columns.positions.astype(np.float64), octree, nodes[at])
            own = rows_of(columns, (part.first <= codes) & (codes < end))
            yield own if counted[at] else dataclasses.replace(own, dropped={})


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
