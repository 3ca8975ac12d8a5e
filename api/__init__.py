"""Splatline: pictures of point clouds as an open-source hardware engine draws them.

Three lines from file to picture:

>>> import splatline
>>> cloud = splatline.read_cloud("scan.ply")
>>> splatline.render(cloud, size=(480, 360), samples=4).save("scan.png")

This folder is the package ``splatline`` itself; every other folder at the root of the repository is
a package in it. Nothing is imported before it is used.
"""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING, Any

# For numba, before it is loaded: OpenMP runs parallel loops, and its threads sleep between them,
# which halves the time of the processor (decision 0087). What the environment says counts more.
if not any(name.startswith("NUMBA_THREADING_LAYER") for name in os.environ):
    os.environ["NUMBA_THREADING_LAYER_PRIORITY"] = "omp tbb workqueue"
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

if TYPE_CHECKING:
    from splatline.contract.errors import InputError
    from splatline.host.cloud.cloud import Cloud
    from splatline.host.files.readers import read_cloud
    from splatline.host.files.wanted import ColourBy
    from splatline.host.scenes.scenes import load_scene
    from splatline.view.camera import Camera
    from splatline.view.film.film import film
    from splatline.view.notebook.show import show
    from splatline.view.picture import Picture, render

    __version__: str

__all__ = [
    "Camera",
    "Cloud",
    "ColourBy",
    "InputError",
    "Picture",
    "__version__",
    "film",
    "load_scene",
    "read_cloud",
    "render",
    "show",
]

_HOMES = {
    "Camera": "view.camera",
    "Cloud": "host.cloud.cloud",
    "ColourBy": "host.files.wanted",
    "InputError": "contract.errors",
    "Picture": "view.picture",
    "film": "view.film.film",
    "load_scene": "host.scenes.scenes",
    "read_cloud": "host.files.readers",
    "render": "view.picture",
    "show": "view.notebook.show",
}


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name == "__version__":
        from importlib.metadata import version

        return version("splatline")
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"splatline.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
