"""The true surface of a built-in scene, rendered without points: a truth that is not of discs.

Each patch is cut into triangles of about a sample's size, whose corners lie on the surface. A
sample takes its two coordinates on the patch from the nearest triangle; position, normal and colour
are the patch's own there. Nothing of a cloud, of its radii or of the encoder is used.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit
from splatline.host.scenes.patches import Patch
from splatline.host.shading.lighting import Lighting
from splatline.host.visibility.view import View

from .reference import Reference, shade

__all__ = ["render_surface"]

PILOT = 256
"""Cells a side of the grid that measures a patch's size on the image."""

EDGE = 1.5
"""Longest edge of a triangle, in samples."""

MOST_CELLS = 4096
"""Most cells of a grid along a side."""

STEP = 1e-6
"""Difference of a coordinate, of 1, by which a patch's slopes are found."""

CHUNK = 1 << 18
"""Corners or samples at a time."""

_Floats = npt.NDArray[np.float64]


def render_surface(
    patches: Sequence[Patch],
    origin: _Floats,
    view: View,
    lighting: Lighting,
    *,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
    samples: int = 4,
    shape_normals: bool = False,
) -> Reference:
    """Render a surface, exactly up to the sampling.

    Parameters
    ----------
    patches
        The surface; all of it lies beyond the near plane and shows its front alone.
    origin
        What a cloud's positions are relative to: ``Cloud.origin``.
    view, lighting, background
        See :func:`splatline.sim.reference.render`.
    samples
        Samples along a side of a pixel.
    shape_normals
        Whether the normals are those of the shape itself, as points without normals show it. Else
        they are the patches', which may be smoother.

    Returns
    -------
    Reference
        The picture, its mean depth, and the coverage of each pixel.
    """
    height, width = view.height * samples, view.width * samples
    depth = np.full((height, width), np.inf)
    owner = np.full((height, width), -1, np.int64)
    at = np.zeros((height, width, 2))
    for number, patch in enumerate(patches):
        cells = _cells(patch, origin, view, samples)
        # A strip at a time, so that a fine grid fits the memory.
        rows = max(1, CHUNK // (cells[1] + 1))
        for start in range(0, cells[0], rows):
            first = np.arange(start, min(start + rows, cells[0]) + 1) / cells[0]
            second = np.arange(cells[1] + 1) / cells[1]
            corners = _project(patch, origin, view, samples, first, second)
            _draw_grid(corners, first, second, number, depth, owner, at)
    rgb = np.broadcast_to(np.asarray(background, np.float64), (height, width, 3)).copy()
    for number, patch in enumerate(patches):
        lines, columns = np.nonzero(owner == number)
        for start in range(0, len(lines), CHUNK):
            part = lines[start : start + CHUNK], columns[start : start + CHUNK]
            positions, normals, colours = patch.at(*at[part].T)
            if shape_normals:
                first, second = at[part].T
                normals = _shape_normals(patch, first, second, positions, normals)
            centres = (positions - origin - view.eye) @ view.axes.T
            rgb[part] = shade(colours, normals @ view.axes.T, centres, lighting)
    hit = owner >= 0
    count = _pixels(hit.astype(np.float64), samples).sum(axis=(1, 3))
    total = _pixels(np.where(hit, depth, 0.0), samples).sum(axis=(1, 3))
    mean = np.divide(total, count, out=np.full(count.shape, np.nan), where=count > 0.0)
    shape = (view.height, samples, view.width, samples, 3)
    return Reference(rgb.reshape(shape).mean(axis=(1, 3)), mean, count / samples**2)


def _shape_normals(
    patch: Patch, first: _Floats, second: _Floats, positions: _Floats, normals: _Floats
) -> _Floats:
    """Return the unit normals of a patch's shape, on the side of its own ``normals``."""
    # Inwards, so that no coordinate leaves 0..1.
    moved = [np.where(share < 0.5, share + STEP, share - STEP) for share in (first, second)]
    along = patch.at(moved[0], second)[0] - positions
    across = patch.at(first, moved[1])[0] - positions
    found = np.cross(along, across)
    length = np.linalg.norm(found, axis=1, keepdims=True)
    side = np.sign(np.einsum("ij,ij->i", found, normals))[:, np.newaxis]
    return np.where(length > 0.0, side * found / np.where(length > 0.0, length, 1.0), normals)


def _pixels(values: _Floats, samples: int) -> _Floats:
    """Return samples by pixel: shape (height, samples, width, samples)."""
    height, width = values.shape
    return values.reshape(height // samples, samples, width // samples, samples)


def _cells(patch: Patch, origin: _Floats, view: View, samples: int) -> tuple[int, int]:
    """Return the cells of a patch's grid along its two coordinates."""
    steps = np.arange(PILOT + 1) / PILOT
    image = _project(patch, origin, view, samples, steps, steps)[..., :2]
    cells = []
    for axis in (0, 1):
        longest = float(np.linalg.norm(np.diff(image, axis=axis), axis=-1).max())
        cells.append(min(max(math.ceil(PILOT * longest / EDGE), 1), MOST_CELLS))
    return cells[0], cells[1]


def _project(
    patch: Patch, origin: _Floats, view: View, samples: int, first: _Floats, second: _Floats
) -> _Floats:
    """Return column, line and depth of a grid's corners, in samples: shape (first, second, 3)."""
    a, b = np.meshgrid(first, second, indexing="ij")
    positions = patch.at(a.ravel(), b.ravel())[0]
    x, y, z = ((positions - origin - view.eye) @ view.axes.T).T
    if not (z >= view.near).all():
        raise ValueError("a true surface must lie beyond the near plane")
    column = samples * (view.middle[0] + view.focal * x / z)
    line = samples * (view.middle[1] + view.focal * y / z)
    return np.stack([column, line, z], axis=-1).reshape(*a.shape, 3)


@cached_njit(error_model="numpy")
def _draw_grid(
    corners: Any, first: Any, second: Any, number: int, depth: Any, owner: Any, at: Any
) -> None:
    """Draw the two triangles of each cell of a grid into the samples."""
    for i in range(corners.shape[0] - 1):
        for j in range(corners.shape[1] - 1):
            for half in range(2):
                # The cell's diagonal is shared; the third corner is the one on the side of `half`.
                _draw_triangle(
                    corners, first, second, (i, j), (i + 1, j + 1), (i + 1 - half, j + half),
                    number, depth, owner, at,
                )  # fmt: skip


@cached_njit(error_model="numpy")
def _draw_triangle(
    corners: Any,
    first: Any,
    second: Any,
    p: Any,
    q: Any,
    r: Any,
    number: int,
    depth: Any,
    owner: Any,
    at: Any,
) -> None:
    """Draw one triangle: the samples whose centre it covers, nearest first."""
    px, py, pz = corners[p[0], p[1], 0], corners[p[0], p[1], 1], corners[p[0], p[1], 2]
    qx, qy, qz = corners[q[0], q[1], 0], corners[q[0], q[1], 1], corners[q[0], q[1], 2]
    rx, ry, rz = corners[r[0], r[1], 0], corners[r[0], r[1], 1], corners[r[0], r[1], 2]
    area = (qx - px) * (ry - py) - (qy - py) * (rx - px)
    if area == 0.0:
        return
    top = max(math.ceil(min(py, min(qy, ry)) - 0.5), 0)
    bottom = min(math.floor(max(py, max(qy, ry)) - 0.5), depth.shape[0] - 1)
    left = max(math.ceil(min(px, min(qx, rx)) - 0.5), 0)
    right = min(math.floor(max(px, max(qx, rx)) - 0.5), depth.shape[1] - 1)
    for line in range(top, bottom + 1):
        for column in range(left, right + 1):
            x, y = column + 0.5, line + 0.5
            of_p = ((qx - x) * (ry - y) - (qy - y) * (rx - x)) / area
            of_q = ((rx - x) * (py - y) - (ry - y) * (px - x)) / area
            of_r = 1.0 - of_p - of_q
            if of_p < -1e-9 or of_q < -1e-9 or of_r < -1e-9:
                continue
            # Linear on the image: 1 / z, and what is divided by z.
            of_p, of_q, of_r = of_p / pz, of_q / qz, of_r / rz
            z = 1.0 / (of_p + of_q + of_r)
            if z < depth[line, column]:
                depth[line, column] = z
                owner[line, column] = number
                at[line, column, 0] = z * (
                    of_p * first[p[0]] + of_q * first[q[0]] + of_r * first[r[0]]
                )
                at[line, column, 1] = z * (
                    of_p * second[p[1]] + of_q * second[q[1]] + of_r * second[r[1]]
                )
