"""Reads clouds of any size for one view: thinned, on the way, to what the view can show."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import bounds, far_points
from splatline.host.cloud.cloud import Cloud
from splatline.host.files.assemble import assemble_cloud
from splatline.host.files.columns import Columns
from splatline.host.files.wanted import ColourBy
from splatline.host.visibility.view import View

from .pieces import Colouring, PieceFile, Sample, colours_of
from .thin import Thinned, Thinner

__all__ = ["CELL_BYTES", "Plan", "read_thinned", "survey"]

CELLS = 2.0
"""Cells of a pixel, along a line and from line to line. Discs are larger than a pixel, so that
finer detail is drawn over."""

CELL_BYTES = 250
"""Most memory that a cell takes: as a point of the cloud, while its disc is measured."""

FIXED_BYTES = 500 << 20
"""Memory that is taken whatever the cloud: programs, a piece, and pictures."""

FEWEST_CELLS = 1 << 16

NORMAL_STEP = 2.0**-20

MOST_STRETCH = 1.25
"""Times as wide as a sample of it a file is, unless it has strays."""

FARTHEST = 4.0
"""Points count up to this many times as far from the eye as the furthest of the sample."""


@dataclasses.dataclass(frozen=True)
class Plan:
    """What is settled before the first point is read, from a sample of each file.

    Parameters
    ----------
    files
        The files.
    colourings
        How each one's values become colours.
    view
        The view; its coordinates are relative to ``origin``.
    origin
        Shape (3,), float64.
    farthest
        Greatest distance along the view at which points count.
    normals
        Whether the files have normals.
    count
        Points that the files promise.
    columns
        Those of the first file's sample: what they were taken for.
    """

    files: tuple[PieceFile, ...]
    colourings: tuple[Colouring, ...]
    view: View
    origin: npt.NDArray[np.float64]
    farthest: float
    normals: bool
    count: int
    columns: Columns


def survey(
    paths: Sequence[Path], by: ColourBy | None, fit: Callable[[Cloud], View], *, bulk: bool = True
) -> Plan:
    """Look at a sample of each file, and settle the view and the colours.

    Parameters
    ----------
    paths
        The files; at least one.
    by
        What colours a point.
    fit
        Returns the view of a cloud, which is the sample.
    bulk
        Whether points far from the rest play no part.

    Raises
    ------
    InputError
        If a file cannot be read, or no point of a sample has a finite position.
    """
    files = tuple(PieceFile(path, by) for path in paths)
    found = [file.sample() for file in files]
    samples = [each.columns for each in found]
    colourings = tuple(file.colouring(sample) for file, sample in zip(files, samples, strict=True))
    positions = np.concatenate([_stretched(each) for each in found])
    if not len(positions):
        raise InputError(f"{paths[0]}: no point of a sample has a finite position")
    if bulk:
        positions = positions[~far_points(positions)]
    low, high = bounds(positions)
    origin = low + 0.5 * (high - low)
    view = fit(_bare(positions - origin, origin, paths[0].stem))
    ahead = (positions - origin - view.eye) @ view.axes[2]
    farthest = FARTHEST * max(float(ahead.max()), view.near)
    normals = all(sample.normals is not None for sample in samples)
    count = sum(each.count for each in found)
    return Plan(files, colourings, view, origin, farthest, normals, count, samples[0])


def _stretched(sample: Sample) -> npt.NDArray[np.float64]:
    """Return a sample's finite positions, stretched to the bounds that its file names.

    A sample misses the outermost points. Bounds that are much wider are those of strays.
    """
    positions = sample.columns.positions.astype(np.float64)
    positions = positions[np.isfinite(positions).all(axis=1)]
    if sample.bounds is None or not len(positions):
        return positions
    low, high = bounds(positions)
    size, to_low, to_high = high - low, *sample.bounds
    grown = (to_low <= low) & (high <= to_high) & (to_high - to_low <= MOST_STRETCH * size)
    scale = np.where(grown & (size > 0.0), (to_high - to_low) / np.maximum(size, 1e-300), 1.0)
    stretched: npt.NDArray[np.float64] = np.where(grown, to_low, low) + (positions - low) * scale
    return stretched


def read_thinned(
    plan: Plan, memory: int, *, progress: Callable[[str, float], None] | None = None
) -> tuple[Cloud, View]:
    """Read the files of a plan, thinned to the cells of its view.

    Points of a cell become one, at their mean position, with the mean of their colours and normals.
    A cell is half a pixel wide, or as many times twice as wide as the memory asks for. The result
    depends neither on the order of the points nor on the pieces in which they are read.

    Parameters
    ----------
    plan
        See :func:`survey`.
    memory
        Bytes that may be used.
    progress
        Called now and then with a stage, ``read`` or ``normals``, and the share of it that is done.

    Returns
    -------
    Cloud
        ``dropped`` has the points left out, by reason: ``outside`` of the view, and ``finer``,
        those that other points stand for.
    View
        The view, in the cloud's coordinates.

    Raises
    ------
    InputError
        If a file is damaged, or the view shows no point.
    """
    thinner = _thinner(plan, memory)
    for number, (file, colouring) in enumerate(zip(plan.files, plan.colourings, strict=True)):
        for columns in file.pieces(_share(progress, number, len(plan.files))):
            add_columns(thinner, columns, colouring, plan.normals)
    return finish(plan, thinner, progress)


def _thinner(plan: Plan, memory: int) -> Thinner:
    """Return what gathers the points of a plan."""
    most = max(FEWEST_CELLS, (memory - FIXED_BYTES) // CELL_BYTES)
    steps = np.ones(3)
    if plan.normals:
        steps = np.concatenate([steps, np.full(3, NORMAL_STEP)])
    return Thinner(plan.view, plan.origin, plan.farthest, steps, CELLS, most)


def add_columns(thinner: Thinner, columns: Columns, colouring: Colouring, normals: bool) -> None:
    """Add a piece of a file."""
    values: npt.NDArray[Any] = colours_of(columns, colouring)
    if normals and columns.normals is not None:
        values = np.concatenate([values, columns.normals.astype(np.float64)], axis=1)
    positions = np.ascontiguousarray(columns.positions, np.float64)
    thinner.add(positions, np.ascontiguousarray(values))


def finish(
    plan: Plan, thinner: Thinner, progress: Callable[[str, float], None] | None
) -> tuple[Cloud, View]:
    """Return the cloud of the gathered cells, and the view in its coordinates."""
    if not len(thinner):
        raise InputError(
            f"nothing of {plan.files[0].path.name} is in view: of {thinner.points:,} points all"
            " lie outside; change the view"
        )
    cells, counts = thinner.grid.cells, (thinner.points, thinner.outside)
    thinned = thinner.result()
    cloud = assemble_cloud(
        _columns(plan, thinned, counts, cells),
        plan.files[0].path.stem,
        progress=None if progress is None else lambda share: progress("normals", share),
    )
    moved = dataclasses.replace(plan.view, eye=plan.view.eye + (plan.origin - cloud.origin))
    return cloud, moved


def _columns(plan: Plan, thinned: Thinned, counts: tuple[int, int], cells: float) -> Columns:
    """Return the columns of the cells."""
    points, outside = counts
    dropped: dict[str, int] = {}
    for file in plan.files:
        for reason, number in file.dropped.items():
            dropped[reason] = dropped.get(reason, 0) + number
    dropped |= {"outside": outside, "finer": points - outside - len(thinned.points)}
    size = f"{1 / cells:g} of a pixel" if cells > 1.0 else f"{1 / cells:g} pixels"
    size = "a pixel" if cells == 1.0 else size
    notes = (
        f"of {points:,} points {len(thinned.points):,} are drawn: those of a cell of {size} are"
        " one; see --memory",
    )
    return Columns(
        thinned.positions,
        thinned.values[:, 3:] if plan.normals else None,
        np.rint(thinned.values[:, :3]).astype(np.uint8),
        plan.columns.used,
        plan.columns.ignored,
        (*plan.columns.notes, *notes),
        dropped,
        facts=plan.columns.facts,
    )


def _bare(positions: npt.NDArray[np.float64], origin: npt.NDArray[np.float64], name: str) -> Cloud:
    """Return a cloud of positions alone, to which a view can be fitted."""
    count = len(positions)
    nothing = np.zeros((count, 3), np.uint8)
    return Cloud(
        positions, nothing.astype(np.float32), nothing, np.ones(count, np.bool_), origin, name, {}
    )


def _share(
    progress: Callable[[str, float], None] | None, number: int, files: int
) -> Callable[[float], None] | None:
    """Return what tells the share of all files when a share of one is read."""
    if progress is None:
        return None
    return lambda share: progress("read", (number + share) / files)
