"""Small clouds for stress cases, and transformations of clouds and scenes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.spacing import splat_radii
from splatline.host.files.assemble import Columns, assemble_cloud
from splatline.host.visibility.view import View, fit_view

from .case import Scene

__all__ = [
    "CLOUDS",
    "SIZE",
    "disc",
    "fitted",
    "frontal",
    "on_grid",
    "scaled",
    "scene_scaled",
    "shifted",
    "sphere",
    "terrain",
    "torus",
]

SIZE = (96, 80)
"""Image size of most cases; it is not square."""

COLOURS = np.array([[250, 40, 30], [30, 200, 60], [40, 60, 240], [240, 220, 40]], np.uint8)

_Floats = npt.NDArray[np.float64]


def sphere(count: int = 2500) -> Columns:
    """Return the columns of a file with points on the unit sphere."""
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Columns(normals, normals, _painted(normals))


def torus(count: int = 2500) -> Columns:
    """Return points on a torus of radii 1 and 0.4, which hides parts of itself."""
    rng = np.random.default_rng(2)
    around, about = rng.uniform(0.0, 2.0 * np.pi, (2, count))
    normals = np.stack(
        [np.cos(around) * np.cos(about), np.sin(about), np.sin(around) * np.cos(about)], axis=1
    )
    middle = np.stack([np.cos(around), np.zeros(count), np.sin(around)], axis=1)
    positions = middle + 0.4 * normals
    return Columns(positions, normals, _painted(positions))


def terrain(side: int = 50) -> Columns:
    """Return a patch of hills about two units wide, on a jittered grid."""
    rng = np.random.default_rng(3)
    grid = (np.stack(np.meshgrid(*[np.arange(side)] * 2), axis=-1).reshape(-1, 2) + 0.5) / side
    x, z = (2.0 * grid - 1.0 + rng.uniform(-0.3, 0.3, grid.shape) / side).T
    height = 0.2 * np.sin(3.0 * x + 1.0) * np.cos(4.0 * z)
    slope_x = 0.6 * np.cos(3.0 * x + 1.0) * np.cos(4.0 * z)
    slope_z = -0.8 * np.sin(3.0 * x + 1.0) * np.sin(4.0 * z)
    normals = np.stack([-slope_x, np.ones_like(x), -slope_z], axis=1)
    positions = np.stack([x, height, z], axis=1)
    return Columns(positions, normals, _painted(positions))


CLOUDS: dict[str, Callable[[], Columns]] = {"sphere": sphere, "torus": torus, "terrain": terrain}
"""The plain clouds, by name."""


def disc(count: int = 1500) -> Columns:
    """Return points in the unit circle of the plane z = 0, facing +z."""
    rng = np.random.default_rng(4)
    radius, angle = np.sqrt(rng.uniform(0.0, 1.0, count)), rng.uniform(0.0, 2.0 * np.pi, count)
    positions = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)], axis=1)
    return Columns(positions, np.tile([0.0, 0.0, 1.0], (count, 1)), _painted(positions))


def _painted(positions: _Floats) -> npt.NDArray[np.uint8]:
    """Return a colour for each point, one of four, constant within a patch of space."""
    patch = np.floor(2.0 * positions + 0.3).astype(np.int64) @ np.array([1, 3, 2])
    return COLOURS[patch % len(COLOURS)]


def shifted(columns: Columns, offset: tuple[float, float, float]) -> Columns:
    """Return a cloud moved by an offset, with float64 coordinates."""
    return dataclasses.replace(columns, positions=columns.positions + np.asarray(offset))


def scaled(columns: Columns, factor: float) -> Columns:
    """Return a cloud with its positions multiplied by a factor."""
    return dataclasses.replace(columns, positions=columns.positions * factor)


def on_grid(columns: Columns, step: float = 2.0**-10) -> Columns:
    """Return a cloud whose coordinates are multiples of a power of two.

    Sums and products of a few such numbers are exact in any order.
    """
    return dataclasses.replace(columns, positions=np.rint(columns.positions / step) * step)


def fitted(columns: Columns, **view: Any) -> Scene:
    """Return a scene as the command draws it: view fitted to the cloud, discs by its spacing."""
    cloud = assemble_cloud(columns, "stress")
    return Scene(cloud, fit_view(cloud, **{"size": SIZE, **view}), splat_radii(cloud))


def frontal(
    columns: Columns, distance: float = 4.0, *, focal: float = 100.0, near: float = 1e-3
) -> Scene:
    """Return a scene seen along -z from a distance, with camera axes that are exact in float64."""
    cloud = assemble_cloud(columns, "stress")
    axes = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    view = View(np.array([0.0, 0.0, distance]), axes, focal, *SIZE, near)
    return Scene(cloud, view, splat_radii(cloud))


def scene_scaled(scene: Scene, factor: float) -> Scene:
    """Return a scene with cloud, camera and discs multiplied by a factor."""
    cloud: Cloud = dataclasses.replace(
        scene.cloud,
        positions=scene.cloud.positions * factor,
        origin=scene.cloud.origin * factor,
    )
    view = dataclasses.replace(
        scene.view, eye=scene.view.eye * factor, near=scene.view.near * factor
    )
    return dataclasses.replace(scene, cloud=cloud, view=view, radii=scene.radii * factor)
