"""From a file's columns to a cloud: adds missing normals and colours, drops unusable points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import bounds, far_points, lost_points
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.normals import estimate_normals, estimate_surface

from .colouring import Coloured, colour_values, heights
from .colours import NEUTRAL, colours_to_bytes
from .columns import Columns
from .wanted import HEIGHT

__all__ = ["Columns", "assemble_cloud"]

FARTHEST = 1e100
"""Coordinates beyond this count as not finite: their squares would not be."""

PIECE = 1 << 16
"""Normals that are scaled at once, so that what is computed of them stays in the cache."""


def assemble_cloud(
    columns: Columns,
    name: str,
    *,
    origin: npt.NDArray[np.float64] | None = None,
    estimate: bool = True,
    up: str = "y",
    progress: Callable[[float], None] | None = None,
) -> Cloud:
    """Return a cloud about its own centre, the middle of its bounding box.

    Points whose position is not finite are dropped (``Cloud.dropped["non_finite"]``), and so are
    those beyond every scanner's reach (``["far_away"]``, see ``lost_points``). Strays do not move
    the centre. Normals are scaled to unit length; those that are missing, zero or not finite are
    estimated, and their points two-sided. Without colours every point is ``NEUTRAL``; if a field is
    to colour the points, see ``colour_values``.

    Parameters
    ----------
    columns
        The file's columns.
    name
        The cloud's name.
    origin
        Another centre: shape (3,).
    estimate
        Whether missing normals are estimated; if not, they are 0.
    up
        The axis that points up.
    progress
        Called now and then with the share of the normals that are estimated, first with 0; not
        called if none is missing.

    Raises
    ------
    InputError
        If there is no point, or none with a finite position.
    """
    count = len(columns.positions)
    if not count:
        raise InputError("has no points")
    # Compiled code is made for one layout of an array, rows of x, y, z.
    positions = np.array(columns.positions, np.float64, order="C")
    kept = _are_finite(positions)
    if not kept.any():
        raise InputError(f"none of its {count} points has a finite position")
    finite = int(np.count_nonzero(kept))
    positions = _rows(positions, kept)
    lost = lost_points(positions)
    positions = _rows(positions, ~lost)
    kept[kept] = ~lost
    usual = ~far_points(positions)
    if origin is None:
        low, high = bounds(_rows(positions, usual))
        origin = low + 0.5 * (high - low)
    positions -= origin

    normals, missing = _unit_normals(columns.normals, kept)
    coloured = _colours(columns, kept, positions, origin, usual)
    cloud = Cloud(
        positions=positions,
        normals=normals,
        colours=coloured.colours,
        two_sided=missing | columns.two_sided,
        origin=origin,
        name=name,
        dropped={
            "non_finite": count - finite,
            **columns.dropped,
            **({"far_away": int(np.count_nonzero(lost))} if lost.any() else {}),
        },
        used=columns.used,
        ignored=columns.ignored,
        notes=columns.notes,
        colour_key=coloured.key,
        facts=columns.facts,
        radii=None if columns.radii is None else _rows(columns.radii, kept).astype(np.float64),
        up=up,
    )
    if estimate and missing.any():
        if progress is not None:
            progress(0.0)
        if missing.all() and usual.all():
            estimate_surface(cloud, progress=progress)
        else:
            normals[missing] = estimate_normals(
                positions, missing, cells=cloud.cells, progress=progress
            )
    return cloud


def _are_finite(positions: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return which positions can be used; most clouds need no look at each row."""
    if max(float(positions.max()), -float(positions.min())) <= FARTHEST:  # false for NaN
        return np.ones(len(positions), np.bool_)
    usable: npt.NDArray[np.bool_] = np.all(np.abs(positions) <= FARTHEST, axis=1)
    return usable


def _rows(array: npt.NDArray[Any], kept: npt.NDArray[np.bool_]) -> npt.NDArray[Any]:
    """Return some rows, or the array itself if these are all."""
    return array if kept.all() else array[kept]


def _colours(
    columns: Columns,
    kept: npt.NDArray[np.bool_],
    positions: npt.NDArray[np.float64],
    origin: npt.NDArray[np.float64],
    usual: npt.NDArray[np.bool_],
) -> Coloured:
    """Return the colours of the points that are kept; ``usual`` do not lie far from the rest."""
    by = columns.colour
    if by is not None and by.kind == HEIGHT:
        return colour_values(heights(positions, origin, by.up), by, usual)
    if by is not None and columns.values is not None:
        return colour_values(_rows(columns.values, kept), by)
    if columns.colours is None:
        return Coloured(np.tile(np.array(NEUTRAL, np.uint8), (len(positions), 1)), {})
    return Coloured(colours_to_bytes(_rows(columns.colours, kept)), {})


def _unit_normals(
    normals: npt.NDArray[Any] | None, kept: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.bool_]]:
    """Return unit normals, and where one is missing; missing normals are 0."""
    if normals is None:
        count = int(np.count_nonzero(kept))
        return np.zeros((count, 3), np.float32), np.ones(count, np.bool_)
    rows = _rows(normals, kept)
    units, missing = np.empty(rows.shape, np.float32), np.empty(len(rows), np.bool_)
    for start in range(0, len(rows), PIECE):
        piece = slice(start, start + PIECE)
        units[piece], missing[piece] = _unit_rows(rows[piece].astype(np.float64))
    return units, missing


def _unit_rows(
    rows: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """Return rows at unit length, and which have none; those are 0. ``rows`` is overwritten."""
    squares = np.einsum("ij,ij->i", rows, rows)
    if squares.min() > 1e-200 and squares.max() < 1e200:  # false for NaN
        rows /= np.sqrt(squares)[:, np.newaxis]
        return rows, np.zeros(len(rows), np.bool_)
    missing = ~np.isfinite(rows).all(axis=1)
    rows[missing] = 0.0
    # The largest component first, so that no square over- or underflows.
    size = np.abs(rows).max(axis=1, keepdims=True)
    rows /= np.where(size > 0.0, size, 1.0)
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    missing |= length[:, 0] == 0.0
    rows /= np.where(length > 0.0, length, 1.0)
    return rows, missing
