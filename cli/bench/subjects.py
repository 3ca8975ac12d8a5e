"""Inputs of the benchmarks: built-in scenes and clouds from files, in one view or several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from splatline.host.cloud.cloud import Cloud
    from splatline.host.visibility.view import View

__all__ = ["Pose", "check_names", "poses"]


@dataclass(frozen=True)
class Pose:
    """A cloud with a view of it.

    Parameters
    ----------
    name, source
        Name of the cloud, and its scene or file.
    cloud, view, camera
        The cloud, its view, and the parameters of the view.
    radii
        Radii of the discs by the points' own spacing: shape (n,).
    usual
        Median diameter of these discs in pixels.
    """

    name: str
    source: str
    cloud: Cloud
    view: View
    camera: dict[str, Any]
    radii: npt.NDArray[np.float64]
    usual: float

    def scaled(self, diameter: float | None) -> npt.NDArray[np.float64]:
        """Return radii with a median diameter in pixels; None: by the points' own spacing."""
        return self.radii if diameter is None else self.radii * (diameter / self.usual)


def check_names(scenes: Sequence[str], clouds: Sequence[Path]) -> list[str]:
    """Return the names of scenes and clouds.

    Raises
    ------
    InputError
        If a scene is unknown, a file is missing, or two clouds have the same name.
    """
    from splatline.contract.errors import InputError
    from splatline.host.scenes.scenes import SCENES

    unknown = [name for name in scenes if name not in SCENES]
    if unknown:
        raise InputError(f"no scene named {unknown[0]!r}; there are: {', '.join(SCENES)}")
    missing = [path for path in clouds if not path.is_file()]
    if missing:
        raise InputError(f"{missing[0]}: no such file")
    names = [*scenes, *(path.stem for path in clouds)]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"two clouds are called {twice[0]!r}; rename one of them")
    return names


def poses(
    scenes: Sequence[str],
    clouds: Sequence[Path],
    size: tuple[int, int],
    views: Sequence[tuple[float, float]] = (),
) -> Iterator[Pose]:
    """Load each scene and cloud once, and yield it in each view.

    Parameters
    ----------
    scenes, clouds
        Names of built-in scenes, and cloud files.
    size
        Size of the image.
    views
        Orbits; empty: each scene's own orbit, and the default orbit for a cloud file.
    """
    import numpy as np

    from splatline.host.cloud.spacing import splat_radii
    from splatline.host.files.readers import read_cloud
    from splatline.host.scenes.scenes import load_scene
    from splatline.host.visibility.view import fit_view

    for what in (*scenes, *clouds):
        camera: dict[str, Any] = {"orbit": (30.0, 20.0), "fov": 35.0, "up": "y", "zoom": 1.0}
        if isinstance(what, Path):
            cloud, name, source = read_cloud(what), what.stem, what.name
        else:
            scene = load_scene(what)
            cloud, name, source = scene.cloud, what, f"scene {what}"
            camera |= {key: getattr(scene, key) for key in camera}
        radii = splat_radii(cloud)
        for orbit in views or (camera["orbit"],):
            camera["orbit"] = orbit
            view = fit_view(cloud, size=size, **camera)
            depth = (cloud.positions - view.eye) @ view.axes[2]
            usual = float(np.median(2.0 * radii * view.focal / depth))
            yield Pose(name, source, cloud, view, dict(camera), radii, usual)
