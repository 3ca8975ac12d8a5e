"""Plan of a picture before a large cloud is read: view, colours and range of depths."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import bounds, far_points
from splatline.host.cloud.cloud import Cloud
from splatline.host.files.wanted import ColourBy
from splatline.host.shading.materials import find_materials
from splatline.host.visibility.view import View

from .nodes import choose_nodes
from .octree_parts import cut_octree
from .pieces import Colouring, PieceFile, Sample, colours_of
from .thin import CELLS, grid_of

__all__ = ["Part", "Plan", "make_plan"]

FARTHEST = 4.0
"""Points count up to this many times as far from the eye as the furthest of the sample."""

MOST_STRETCH = 1.25
"""Times as wide as a sample of it a file is, unless it has strays."""

DEPTH_MARGIN = 0.05
"""Share by which the range of depths is longer than the sample's, at each end."""

PART_POINTS = 1 << 25
"""Most points of a part of a file."""

NODE_POINTS = 1 << 22
"""Most points of the nodes of a part of a COPC file, or about so. Each of them may need a cell of
its own, since finer nodes are not read."""

_Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Part:
    """Some points of a file: those from ``first`` up to ``stop``.

    Parameters
    ----------
    file
        Number of the file.
    first, stop
        Numbers of points; ``stop`` None: to the end. Of a COPC file they are the codes of cells of
        its octree: see :mod:`splatline.host.large.octree_parts`.
    """

    file: int
    first: int = 0
    stop: int | None = None


@dataclasses.dataclass(frozen=True)
class Plan:
    """Values that all parts of a picture share, from a sample of each file.

    Parameters
    ----------
    files
        The files.
    colourings
        How each one's values become colours.
    parts
        The parts of the files. They depend on the files alone; those of a COPC file on the view,
        too.
    view
        The view; its coordinates are relative to ``origin``.
    origin
        Shape (3,), float64.
    farthest
        Greatest distance along the view at which points count.
    depth_range
        Distances along the view of depth 0 and of the largest depth.
    palette
        Colours of the materials: shape (m, 3), uint8.
    count
        Points that the files promise.
    """

    files: tuple[PieceFile, ...]
    colourings: tuple[Colouring, ...]
    parts: tuple[Part, ...]
    view: View
    origin: _Floats
    farthest: float
    depth_range: tuple[float, float]
    palette: npt.NDArray[np.uint8]
    count: int


def make_plan(
    paths: Sequence[Path],
    by: ColourBy | None,
    fit: Callable[[Cloud], View],
    most_materials: int,
    *,
    bulk: bool = True,
    keep: frozenset[str] = frozenset(),
) -> Plan:
    """Look at a sample of each file, and settle what all parts share.

    Parameters
    ----------
    paths
        The files; at least one.
    by
        What colours a point.
    fit
        Returns the view of a cloud, which is the sample.
    most_materials
        Most colours of the palette.
    bulk
        Whether points far from the rest play no part.
    keep
        Points that are drawn though they usually are not; see ``read_cloud``.

    Raises
    ------
    InputError
        If a file cannot be read, or no point of the samples has a finite position.
    """
    files = tuple(PieceFile(path, by, keep) for path in paths)
    samples = [file.sample() for file in files]
    colourings = tuple(
        file.colouring(sample.columns) for file, sample in zip(files, samples, strict=True)
    )
    pairs = list(zip(samples, colourings, strict=True))
    positions = np.concatenate([_stretched(sample) for sample in samples])
    colours = np.concatenate([colours_of(sample.columns, each) for sample, each in pairs])
    kept = np.isfinite(positions).all(axis=1)
    if not kept.any():
        raise InputError(f"{paths[0]}: no point of a sample has a finite position")
    positions = positions[kept]
    if bulk:
        positions = positions[~far_points(positions)]
    low, high = bounds(positions)
    origin = low + 0.5 * (high - low)
    view = fit(_bare(positions - origin, origin, paths[0].stem))
    ahead = (positions - origin - view.eye) @ view.axes[2]
    nearest, furthest = max(float(ahead.min()), view.near), max(float(ahead.max()), view.near)
    margin = DEPTH_MARGIN * (furthest - nearest)
    farthest = FARTHEST * furthest
    return Plan(
        files=files,
        colourings=colourings,
        parts=tuple(_parts(files, samples, view, origin, farthest)),
        view=view,
        origin=origin,
        farthest=farthest,
        depth_range=(max(nearest - margin, view.near), furthest + margin),
        palette=find_materials(_bare(positions, origin, "", colours), most_materials).palette,
        count=sum(sample.count for sample in samples),
    )


def _parts(
    files: Sequence[PieceFile],
    samples: Sequence[Sample],
    view: View,
    origin: _Floats,
    farthest: float,
) -> Iterator[Part]:
    """Yield the parts of the files, each of about as many points."""
    for number, (file, sample) in enumerate(zip(files, samples, strict=True)):
        if file.octree is not None:
            grid = grid_of(view, CELLS, farthest)
            needed = choose_nodes(file.octree, view, origin, grid).needed
            for first, stop in cut_octree(file.octree.nodes[needed], NODE_POINTS):
                yield Part(number, first, stop)
            continue
        parts = -(-sample.count // PART_POINTS) if sample.in_pieces else 1
        cuts = [part * sample.count // parts for part in range(parts)]
        for first, end in zip(cuts, [*cuts[1:], None], strict=True):
            yield Part(number, first, end)


def _stretched(sample: Sample) -> _Floats:
    """Return a sample's positions, stretched to the bounds that its file names.

    A sample misses the outermost points. Bounds that are much wider are those of strays.
    """
    positions = sample.columns.positions.astype(np.float64)
    finite = positions[np.isfinite(positions).all(axis=1)]
    if sample.bounds is None or not len(finite):
        return positions
    low, high = bounds(finite)
    size, to_low, to_high = high - low, *sample.bounds
    grown = (to_low <= low) & (high <= to_high) & (to_high - to_low <= MOST_STRETCH * size)
    grown &= size > 0.0
    scale = np.where(grown, (to_high - to_low) / np.where(grown, size, 1.0), 1.0)
    stretched: _Floats = np.where(grown, to_low, low) + (positions - low) * scale
    return stretched


def _bare(
    positions: _Floats, origin: _Floats, name: str, colours: npt.NDArray[np.uint8] | None = None
) -> Cloud:
    """Return a cloud of positions, and colours, alone."""
    count = len(positions)
    if colours is None:
        colours = np.zeros((count, 3), np.uint8)
    none = np.zeros((count, 3), np.float32)
    return Cloud(positions, none, colours, np.ones(count, np.bool_), origin, name, {})
