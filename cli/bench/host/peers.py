"""Other renderers of point clouds: seconds a frame for the same view, with the cloud in memory."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View

__all__ = ["PEERS", "Times", "least_seconds"]

REPEATS = 3

LEAST_SECONDS = 0.5
"""A renderer draws for at least so long, so that a quick one is not measured by three frames."""


@dataclass(frozen=True)
class Times:
    """Seconds of a renderer: of a frame, and of what it builds once a cloud, if measured."""

    frame: float
    build: float | None = None


def embree_discs(cloud: Cloud, view: View, radii: npt.NDArray[np.float64]) -> Times:
    """Return Embree's seconds: the same discs, a ray a pixel, diffuse light without a highlight."""
    from .embree import EmbreeScene

    with EmbreeScene(cloud, radii) as scene:
        return Times(least_seconds(lambda: scene.draw(view)[0]), scene.build_seconds)


def vtk_points(cloud: Cloud, view: View, radii: npt.NDArray[np.float64]) -> Times:
    """Return VTK's seconds a frame, through PyVista: lit square points of the mean splat size."""
    import numpy as np
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=[view.width, view.height])
    points = pyvista.PolyData(cloud.positions.astype(np.float32))
    points["colour"] = cloud.colours
    points.point_data.active_normals = cloud.normals
    distance = float(np.linalg.norm(view.eye))
    size = max(1.0, 2.0 * float(radii.mean()) * view.focal / distance)
    plotter.add_mesh(points, scalars="colour", rgb=True, point_size=size, lighting=True)
    plotter.camera.position = tuple(view.eye)
    plotter.camera.focal_point = tuple(view.eye + view.axes[2])
    plotter.camera.up = tuple(-view.axes[1])
    plotter.camera.view_angle = float(np.degrees(2 * np.arctan(0.5 * view.height / view.focal)))
    plotter.show(auto_close=False)

    def draw() -> Any:
        plotter.render()
        return plotter.screenshot(return_img=True)

    seconds = least_seconds(lambda: _timed(draw))
    plotter.close()
    return Times(seconds)


def open3d_offscreen(cloud: Cloud, view: View, radii: npt.NDArray[np.float64]) -> Times:
    """Return the seconds a frame of Open3D's off-screen renderer: lit points of the mean size."""
    os.environ.setdefault("EGL_PLATFORM", "surfaceless")
    import numpy as np
    import open3d

    renderer = open3d.visualization.rendering.OffscreenRenderer(view.width, view.height)
    points = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(cloud.positions))
    points.normals = open3d.utility.Vector3dVector(cloud.normals.astype(np.float64))
    points.colors = open3d.utility.Vector3dVector(cloud.colours / 255.0)
    material = open3d.visualization.rendering.MaterialRecord()
    material.shader = "defaultLit"
    distance = float(np.linalg.norm(view.eye))
    material.point_size = max(1.0, 2.0 * float(radii.mean()) * view.focal / distance)
    renderer.scene.add_geometry("cloud", points, material)
    renderer.setup_camera(
        float(np.degrees(2 * np.arctan(0.5 * view.height / view.focal))),
        view.eye + view.axes[2],
        view.eye,
        -view.axes[1],
    )
    return Times(least_seconds(lambda: _timed(renderer.render_to_image)))


PEERS: dict[str, Callable[..., Times]] = {
    "Embree discs": embree_discs,
    "VTK points (PyVista)": vtk_points,
    "Open3D off-screen": open3d_offscreen,
}
"""Functions by the renderer's name; each raises if its renderer cannot run here."""


def least_seconds(draw: Callable[[], float]) -> float:
    """Return the least of the seconds of several frames; a first frame for set-up is left out."""
    draw()
    least, frames = float("inf"), 0
    begin = time.perf_counter()
    while frames < REPEATS or time.perf_counter() - begin < LEAST_SECONDS:
        least = min(least, draw())
        frames += 1
    return least


def _timed(draw: Callable[[], Any]) -> float:
    """Return the seconds of a call."""
    begin = time.perf_counter()
    draw()
    return time.perf_counter() - begin
