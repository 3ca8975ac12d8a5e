"""The host: from a point cloud to the code words that an engine draws.

>>> from splatline import host, sim
>>> cloud = host.read_cloud("scan.ply")
>>> frame = host.make_frame(cloud, host.fit_view(cloud), radii=host.splat_radii(cloud))
>>> picture = sim.golden.render(frame).to_rgb()
"""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {
    "Cloud": "cloud",
    "Columns": "assemble",
    "Frame": "frame",
    "Index": "index",
    "InputError": "errors",
    "Light": "lighting",
    "Lighting": "lighting",
    "Materials": "materials",
    "Scene": "scenes",
    "Tables": "frame",
    "SKIPS": "skips",
    "View": "view",
    "assemble_cloud": "assemble",
    "build_index": "index",
    "find_materials": "materials",
    "fit_view": "view",
    "load_frame": "store",
    "load_scene": "scenes",
    "make_frame": "pipeline",
    "make_frames": "pipeline",
    "read_cloud": "readers",
    "save_frame": "store",
    "splat_radii": "spacing",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that importing the package costs nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
