"""What is settled before a large cloud is read: view, colours and range of depths."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import bounds, far_points
from splatline.host.cloud.cloud import Cloud
from splatline.host.files.wanted import ColourBy
from splatline.host.shading.materials import find_materials
from splatline.host.visibility.view import View

from .pieces import Colouring, PieceFile, Sample, colours_of

__all__ = ["Part", "Plan", "make_plan"]

FARTHEST = 4.0
"""Points count up to this many times as far from the eye as the furthest of the sample."""

MOST_STRETCH = 1.25
"""Times as wide as a sample of it a file is, unless it has strays."""

DEPTH_MARGIN = 0.05
"""Share by which the range of depths is longer than the sample's, at each end."""

PART_POINTS = 1 << 25
"""Most points of a part of a file."""

_Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Part:
    """Some points of a file: those from ``first`` up to ``stop``.

    Parameters
    ----------
    file
        Number of the file.
    first, stop
        Numbers of points; ``stop`` None: to the end.
    """

    file: int
    first: int = 0
    stop: int | None = None


@dataclasses.dataclass(frozen=True)
class Plan:
    """What all parts of a picture share, from a sample of each file.

    Parameters
    ----------
    files
        The files.
    colourings
        How each one's values become colours.
    parts
        The parts of the files. They depend on the files alone.
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

    Raises
    ------
    InputError
        If a file cannot be read, or no point of the samples has a finite position.
    """
    files = tuple(PieceFile(path, by) for path in paths)
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
    return Plan(
        files=files,
        colourings=colourings,
        parts=tuple(_parts(samples)),
        view=view,
        origin=origin,
        farthest=FARTHEST * furthest,
        depth_range=(max(nearest - margin, view.near), furthest + margin),
        palette=find_materials(_bare(positions, origin, "", colours), most_materials).palette,
        count=sum(sample.count for sample in samples),
    )


def _parts(samples: Sequence[Sample]) -> list[Part]:
    """Return the parts of the files, each of about as many points."""
    found = []
    for number, sample in enumerate(samples):
        parts = -(-sample.count // PART_POINTS) if sample.in_pieces else 1
        cuts = [part * sample.count // parts for part in range(parts)]
        found += [Part(number, *ends) for ends in zip(cuts, [*cuts[1:], None], strict=True)]
    return found


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
