"""An index of a cloud, built once: neighbouring points in blocks, with bounds to cull whole blocks.

Every later stage works in the index's order, so that neighbours in space are neighbours in memory
and on the image.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.prefetch import AHEAD, prefetch
from splatline.host.compiled_cache import cached_njit
from splatline.host.shading.materials import Materials, find_materials

from .groups import GROUP_POINTS, bound_group
from .point_records import MATERIAL, NORMAL, POINT, RADIUS, THIN, TWO_SIDED, views

__all__ = ["BLOCK_BITS", "BLOCK_POINTS", "Index", "build_index"]

BLOCK_BITS = 7

BLOCK_POINTS = 1 << BLOCK_BITS
"""Points of a block: so many that testing blocks is cheap, so few that bounds are tight
(decision 0014)."""

BOUND = np.dtype(
    [
        ("centre", np.float64, 3),  # of the sphere about the points
        ("reach", np.float64),  # its radius
        ("largest", np.float64),  # radius of the largest disc
        ("mean", np.float64),  # of the discs' radii
        ("axis", np.float64, 3),  # of the cone about the normals
        ("sine", np.float64),  # of the angle between axis and furthest normal; 2: there is no cone
        ("thin", np.bool_),  # whether one of the points is thin
    ]
)
"""Bounds of a block."""


@dataclass(frozen=True)
class Index:
    """A cloud's points along a space-filling curve, in blocks of ``BLOCK_POINTS``.

    It takes 83 bytes a point, those of blocks included, beyond the cloud itself.

    Parameters
    ----------
    cloud
        The cloud that is indexed.
    point
        Index into the cloud: shape (n,), int32.
    points
        In this order: shape (n,), structured, see ``POINT``.
    discs
        Of the quick test, rounded, by group: shape (ceil(n / GROUP_POINTS), 7, GROUP_POINTS),
        float32. Of each point its position relative to the middle of the block's bounding sphere,
        in its radii; the disc's radius over the block's largest; the normal. The radius of a thin
        point is infinite, and that of a two-sided one has a minus.
    materials
        The palette, and each point's colour of it in this order: a view of ``points``.
    bounds
        Of each block: shape (ceil(n / BLOCK_POINTS),), structured, see ``BOUND``.
    groups
        Spheres about the discs of each group of a block: shape
        (blocks, 4, BLOCK_POINTS // GROUP_POINTS), float32; see ``bound_group``.
    """

    cloud: Cloud
    point: npt.NDArray[np.int32]
    points: npt.NDArray[Any]
    discs: npt.NDArray[np.float32]
    materials: Materials
    bounds: npt.NDArray[Any]
    groups: npt.NDArray[np.float32]

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.point)

    @property
    def nbytes(self) -> int:
        """Bytes that the index takes beyond the cloud."""
        parts = self.point, self.points, self.discs, self.bounds, self.groups
        return sum(part.nbytes for part in parts)


def build_index(
    cloud: Cloud,
    radii: npt.NDArray[np.floating[Any]],
    materials: Materials | None = None,
    thin: npt.NDArray[np.bool_] | None = None,
) -> Index:
    """Return the index of a cloud.

    Parameters
    ----------
    cloud
        The points.
    radii
        Radius of each point's disc, in the cloud's unit: shape (n,); see ``splat_radii``.
    materials
        The cloud's palette; None: it is computed.
    thin
        Which points are drawn even where their discs cover no pixel's centre: shape (n,); see
        ``Discs``. None: none.

    Raises
    ------
    InputError
        If a radius is missing, negative or not finite.
    """
    radii = np.ascontiguousarray(radii, np.float64)
    _check_radii(radii, len(cloud))
    if materials is None:
        materials = find_materials(cloud)
    order = cloud.curve.order
    count = len(order)
    blocks = -(-count // BLOCK_POINTS)
    points = np.empty(count, POINT)
    index = Index(
        cloud=cloud,
        point=order,
        points=points,
        discs=np.empty((-(-count // GROUP_POINTS), 7, GROUP_POINTS), np.float32),
        materials=Materials(materials.palette, points["material"]),
        bounds=np.empty(blocks, BOUND),
        groups=np.empty((blocks, 4, BLOCK_POINTS // GROUP_POINTS), np.float32),
    )
    index.discs[-1:] = 0.0  # the last group may have places that no point takes
    _gather(
        order,
        cloud.positions,
        cloud.normals,
        cloud.two_sided,
        radii,
        materials.index,
        np.zeros(count, np.bool_) if thin is None else thin,
        views(points),
        index.discs,
        index.bounds,
        index.groups,
    )
    return index


def _check_radii(radii: npt.NDArray[np.floating[Any]], count: int) -> None:
    """Raise ``InputError`` unless there is a length for every point."""
    if np.shape(radii) != (count,):
        raise InputError(f"there must be one radius a point, {count}, not {np.shape(radii)}")
    if count and not (np.isfinite(radii).all() and np.min(radii) >= 0.0):
        raise InputError("every radius must be a finite length, 0 or more")


@cached_njit(parallel=True, error_model="numpy")
def _gather(
    order: Any,
    from_positions: Any,
    from_normals: Any,
    from_two_sided: Any,
    from_radii: Any,
    from_material: Any,
    from_thin: Any,
    points: Any,
    discs: Any,
    bounds: Any,
    groups: Any,
) -> None:
    """Copy the points in the index's order, and bound each block and its groups."""
    own_doubles, own_floats, own_bytes = points
    for block in nb.prange(len(bounds)):
        start = block * BLOCK_POINTS
        stop = min(start + BLOCK_POINTS, len(order))
        for i in range(start, stop):
            j = order[i]
            ahead = order[min(i + AHEAD, len(order) - 1)]
            prefetch(from_positions, 24 * ahead)
            prefetch(from_normals, 12 * ahead)
            prefetch(from_radii, 8 * ahead)
            prefetch(from_two_sided, ahead)
            prefetch(from_material, ahead)
            prefetch(from_thin, ahead)
            for axis in range(3):
                own_doubles[i, axis] = from_positions[j, axis]
                own_floats[i, NORMAL + axis] = from_normals[j, axis]
            own_doubles[i, RADIUS] = from_radii[j]
            own_bytes[i, MATERIAL], own_bytes[i, TWO_SIDED] = from_material[j], from_two_sided[j]
            own_bytes[i, THIN] = from_thin[j]
        _bound_sphere(bounds[block], own_doubles[start:stop])
        _bound_cone(
            bounds[block], own_floats[start:stop, NORMAL:], own_bytes[start:stop, TWO_SIDED]
        )
        bounds[block].thin = own_bytes[start:stop, THIN].any()
        reach, largest = bounds[block].reach, bounds[block].largest
        for i in range(start, stop):
            group, at = i // GROUP_POINTS, i % GROUP_POINTS
            for axis in range(3):
                offset = own_doubles[i, axis] - bounds[block].centre[axis]
                discs[group, axis, at] = offset / reach if reach > 0.0 else 0.0
                discs[group, 4 + axis, at] = own_floats[i, NORMAL + axis]
            share = own_doubles[i, RADIUS] / largest if largest > 0.0 else 0.0
            share = np.inf if own_bytes[i, THIN] else share
            discs[group, 3, at] = -share if own_bytes[i, TWO_SIDED] else share
        for first in range(start, stop, GROUP_POINTS):
            last = min(first + GROUP_POINTS, stop)
            group = groups[block, :, (first - start) // GROUP_POINTS]
            bound_group(discs[first // GROUP_POINTS], last - first, bounds[block], group)


@cached_njit(error_model="numpy")
def _bound_sphere(bound: Any, points: Any) -> None:
    """Set the sphere about a block's points, and the sizes of its discs."""
    for axis in range(3):
        low = high = points[0, axis]
        for i in range(1, len(points)):
            low, high = min(low, points[i, axis]), max(high, points[i, axis])
        bound.centre[axis] = low + 0.5 * (high - low)
    reach, largest, total = 0.0, 0.0, 0.0
    for i in range(len(points)):
        dx = points[i, 0] - bound.centre[0]
        dy = points[i, 1] - bound.centre[1]
        dz = points[i, 2] - bound.centre[2]
        # Not a sum of squares: those of a tiny cloud underflow.
        reach = max(reach, np.hypot(np.hypot(dx, dy), dz))
        largest = max(largest, points[i, RADIUS])
        total += points[i, RADIUS]
    bound.reach = reach * (1.0 + 1e-9)
    bound.largest = largest
    bound.mean = total / len(points)


@cached_njit(error_model="numpy")
def _bound_cone(bound: Any, normals: Any, two_sided: Any) -> None:
    """Set the cone about a block's normals; there is none if one is two-sided or 90 degrees off."""
    x, y, z = 0.0, 0.0, 0.0
    has_two_sided = False
    for i in range(len(normals)):
        x += normals[i, 0]
        y += normals[i, 1]
        z += normals[i, 2]
        has_two_sided |= two_sided[i]
    length = np.sqrt(x * x + y * y + z * z)
    bound.sine = 2.0
    bound.axis[:] = 0.0
    if has_two_sided or not length > 0.0:
        return
    x, y, z = x / length, y / length, z / length
    cosine = 1.0
    for i in range(len(normals)):
        cosine = min(cosine, x * normals[i, 0] + y * normals[i, 1] + z * normals[i, 2])
    # The margin covers normals that float32 rounded.
    cosine -= 1e-6
    if cosine > 0.0:
        bound.axis[0], bound.axis[1], bound.axis[2] = x, y, z
        bound.sine = np.sqrt(1.0 - cosine * cosine)
