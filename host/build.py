"""From bare arrays to a cloud: checks, what is dropped, what is filled in."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .cloud import Cloud
from .errors import InputError
from .normals import estimate_normals

__all__ = ["LARGEST_COORDINATE", "NEUTRAL_COLOUR", "build_cloud", "to_uint8"]

NEUTRAL_COLOUR = (222, 206, 184)
"""Colour of a cloud that has none: warm, so that the three channels step at different brightness
and nine bits show more than eight greys."""

LARGEST_COORDINATE = 1e100
"""Coordinates beyond it count as not finite: their squares must not overflow."""


def build_cloud(
    positions: npt.ArrayLike,
    normals: npt.ArrayLike | None = None,
    colours: npt.ArrayLike | None = None,
    *,
    name: str = "cloud",
) -> Cloud:
    """Return a cloud made of arrays.

    Points with a coordinate that is not finite are dropped. Normals that are missing, zero or not
    finite are estimated from the neighbours and become two-sided; the others are brought to length 1.

    Parameters
    ----------
    positions
        Shape (n, 3), any number type, in any unit.
    normals
        Shape (n, 3), any length, pointing out of the surface.
    colours
        Shape (n, 3) or (n, 4), red, green, blue (and alpha, ignored): see :func:`to_uint8`. Without
        them every point is ``NEUTRAL_COLOUR``.
    name
        What to call the cloud in messages.

    Returns
    -------
    Cloud
        Its ``origin`` is the middle of the bounding box.

    Raises
    ------
    InputError
        If an array has the wrong shape or type, or no point is left.
    """
    places = _table("positions", positions, (3,), name).astype(np.float64)
    if not len(places):
        raise InputError(f"{name}: has no points")
    # NaN compares false, so it is dropped too.
    finite = (np.abs(places) <= LARGEST_COORDINATE).all(axis=1)
    kept = int(np.count_nonzero(finite))
    if not kept:
        raise InputError(f"{name}: not one of its {len(places)} points has finite coordinates")
    dropped = {"not_finite": len(places) - kept} if kept < len(places) else {}

    if colours is None:
        levels = np.broadcast_to(np.array(NEUTRAL_COLOUR, np.uint8), places.shape)
    else:
        levels = to_uint8(_table("colours", colours, (3, 4), name)[:, :3])
    if normals is None:
        directions = np.zeros(places.shape, np.float32)
    else:
        directions = _unit(_table("normals", normals, (3,), name))
    for label, array in (("colours", levels), ("normals", directions)):
        if len(array) != len(places):
            raise InputError(f"{name}: has {len(places)} positions but {len(array)} {label}")

    places, directions, levels = places[finite], directions[finite], levels[finite]
    low, high = places.min(axis=0), places.max(axis=0)
    origin = low + 0.5 * (high - low)
    places -= origin
    unknown = ~directions.any(axis=1)
    if unknown.any():
        directions[unknown] = estimate_normals(places, unknown)
    return Cloud(
        positions=places,
        normals=directions,
        colours=np.ascontiguousarray(levels),
        two_sided=unknown,
        origin=origin,
        name=name,
        dropped=dropped,
    )


def to_uint8(colours: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return colours of any number type as 0..255.

    Full brightness is 1 for floats that go no higher, 255 for integers and for floats up to 255, and
    65535 beyond. (Files often carry 8-bit values in wider types, so the type alone does not tell.)
    NaN becomes 0, and values outside the range its nearer end.

    Parameters
    ----------
    colours
        Shape (n, 3).
    """
    if colours.dtype == np.uint8:
        return colours.copy()
    levels = np.nan_to_num(colours.astype(np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    highest = float(levels.max(initial=0.0))
    if np.issubdtype(colours.dtype, np.floating) and highest <= 1.0:
        full = 1.0
    else:
        full = 255.0 if highest <= 255.0 else 65535.0
    return np.rint(np.clip(levels / full, 0.0, 1.0) * 255.0).astype(np.uint8)


def _table(what: str, values: npt.ArrayLike, columns: tuple[int, ...], name: str) -> Any:
    """Return values as an array of rows of numbers."""
    table = np.asarray(values)
    if table.ndim != 2 or table.shape[1] not in columns:
        wanted = " or ".join(f"(n, {count})" for count in columns)
        raise InputError(f"{name}: the {what} must have shape {wanted}, not {table.shape}")
    if table.dtype.kind not in "iuf":
        raise InputError(f"{name}: the {what} must be numbers, not {table.dtype}")
    return table


def _unit(normals: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return normals of length 1; 0 where they have no direction."""
    wide = normals.astype(np.float64)
    # Scaled by their largest part first, so that no square overflows or vanishes.
    wide[~np.isfinite(wide).all(axis=1)] = 0.0
    largest = np.abs(wide).max(axis=1, initial=0.0)
    known = largest > 0.0
    unit = np.zeros(wide.shape, np.float64)
    scaled = wide[known] / largest[known, np.newaxis]
    unit[known] = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
    return unit.astype(np.float32)
