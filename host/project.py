"""Projection: from points in space to splats on the image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from .cloud import Cloud
from .cull import FACING_AWAY, KEPT, OUTSIDE, REASONS, faces_away, lies_outside
from .shapes import LEVELS, quantise
from .view import View

__all__ = ["Splats", "project"]

STEEPEST = 1e-6
"""Least cosine between a normal and the ray that slopes are computed for: they stay finite."""


@dataclass(frozen=True)
class Splats:
    """The points that a view may show, as ellipses on the image: one row a point.

    Parameters
    ----------
    point
        Index into the cloud: shape (m,), int64, growing.
    column, line
        Centre on the image in pixels: float32.
    depth
        Distance along the view, in the cloud's unit: float64.
    diameter
        Of the disc seen face on, in pixels: float32.
    slope
        n'x and n'y, as they are: shape (m, 2), float32.
    shape
        Quantised n'x and n'y on the image, ``64 * x + y``: uint16.
    shade
        Quantised camera-space normal, likewise: uint16.
    culled
        Points left out, by reason.
    """

    point: npt.NDArray[np.int64]
    column: npt.NDArray[np.float32]
    line: npt.NDArray[np.float32]
    depth: npt.NDArray[np.float64]
    diameter: npt.NDArray[np.float32]
    slope: npt.NDArray[np.float32]
    shape: npt.NDArray[np.uint16]
    shade: npt.NDArray[np.uint16]
    culled: dict[str, int]

    def __len__(self) -> int:
        """Return the number of splats."""
        return len(self.point)


def project(cloud: Cloud, view: View, radii: npt.NDArray[np.floating[Any]]) -> Splats:
    """Project a cloud's discs and leave out what the view does not show.

    A disc with centre p and unit normal n, in camera coordinates, holds the points q = p + d with
    n . d = 0 and |d| <= R. With a = p_x / p_z, b = p_y / p_z, and s, t the offset on the image
    from the centre times p_z / focal, the plane gives d_z = -(n'x s + n'y t), where
    n' = (n_x, n_y) / (n . (a, b, 1)). To first order |d|^2 = s^2 + t^2 + d_z^2: the paper's
    ellipse of radius R focal / p_z pixels.

    Parameters
    ----------
    cloud
        The points.
    view
        Where they are looked at from.
    radii
        Of the discs, in the cloud's unit: shape (n,).

    Returns
    -------
    Splats
        In the cloud's order.
    """
    count = len(cloud)
    status = np.empty(count, np.uint8)
    image = np.empty((count, 5), np.float32)  # column, line, diameter, slopes
    depth = np.empty(count, np.float64)
    levels = np.empty((count, 2), np.uint16)  # shape, shade
    _project(
        cloud.positions,
        cloud.normals,
        cloud.two_sided,
        np.ascontiguousarray(radii, np.float64),
        view.eye,
        view.axes,
        view.focal,
        view.width,
        view.height,
        view.near,
        status,
        image,
        depth,
        levels,
    )
    point = np.flatnonzero(status == KEPT)
    tally = np.bincount(status, minlength=max(REASONS) + 1)
    return Splats(
        point=point,
        column=image[point, 0],
        line=image[point, 1],
        depth=depth[point],
        diameter=image[point, 2],
        slope=image[point, 3:],
        shape=levels[point, 0],
        shade=levels[point, 1],
        culled={name: int(tally[reason]) for reason, name in REASONS.items()},
    )


@nb.njit(parallel=True, cache=True, error_model="numpy")
def _project(
    positions: Any,
    normals: Any,
    two_sided: Any,
    radii: Any,
    eye: Any,
    axes: Any,
    focal: float,
    width: int,
    height: int,
    near: float,
    status: Any,
    image: Any,
    depth: Any,
    levels: Any,
) -> None:
    """Fill in every point's status and, for those kept, the rest."""
    for i in nb.prange(len(positions)):
        dx = positions[i, 0] - eye[0]
        dy = positions[i, 1] - eye[1]
        dz = positions[i, 2] - eye[2]
        z = axes[2, 0] * dx + axes[2, 1] * dy + axes[2, 2] * dz
        if not z >= near:
            status[i] = OUTSIDE
            continue
        a = (axes[0, 0] * dx + axes[0, 1] * dy + axes[0, 2] * dz) / z
        b = (axes[1, 0] * dx + axes[1, 1] * dy + axes[1, 2] * dz) / z
        column = 0.5 * width + focal * a
        line = 0.5 * height + focal * b
        radius = radii[i] * focal / z
        if lies_outside(column, line, radius, width, height):
            status[i] = OUTSIDE
            continue

        wx, wy, wz = normals[i, 0], normals[i, 1], normals[i, 2]
        nx = axes[0, 0] * wx + axes[0, 1] * wy + axes[0, 2] * wz
        ny = axes[1, 0] * wx + axes[1, 1] * wy + axes[1, 2] * wz
        nz = axes[2, 0] * wx + axes[2, 1] * wy + axes[2, 2] * wz
        facing = nx * a + ny * b + nz
        if two_sided[i] and facing > 0.0:
            nx, ny, nz, facing = -nx, -ny, -nz, -facing
        if faces_away(facing) and not two_sided[i]:
            status[i] = FACING_AWAY
            continue
        status[i] = KEPT
        image[i, 0], image[i, 1], image[i, 2] = column, line, 2.0 * radius
        facing = min(facing, -STEEPEST)
        image[i, 3], image[i, 4] = nx / facing, ny / facing
        depth[i] = z
        levels[i, 0] = LEVELS * quantise(nx, facing) + quantise(ny, facing)
        # The eye sees a point near the image's border along a slant, so a front may have n_z >= 0:
        # for shading such a normal counts as just grazing.
        towards = min(nz, 0.0)
        levels[i, 1] = LEVELS * quantise(nx, towards) + quantise(ny, towards)
