"""The host: from a file to the code words that an engine draws.

It imports ``contract``. Start with ``pipeline``, which calls the folders in this order: ``files``,
``cloud``, ``visibility``, ``shading``, ``encode``.

>>> from splatline import host, sim
>>> cloud = host.read_cloud("scan.ply")
>>> frame = host.make_frame(cloud, host.fit_view(cloud), radii=host.splat_radii(cloud))
>>> picture = sim.golden.render(frame).to_rgb()
"""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {
    "Cloud": "host.cloud.cloud",
    "ColourBy": "host.files.wanted",
    "Columns": "host.files.assemble",
    "Frame": "contract.frame",
    "Index": "host.visibility.block_index",
    "InputError": "contract.errors",
    "Light": "host.shading.lighting",
    "Lighting": "host.shading.lighting",
    "Materials": "host.shading.materials",
    "Scene": "host.scenes.scenes",
    "Tables": "contract.frame",
    "SKIPS": "host.visibility.skips",
    "View": "host.visibility.view",
    "assemble_cloud": "host.files.assemble",
    "build_index": "host.visibility.block_index",
    "find_materials": "host.shading.materials",
    "fit_view": "host.visibility.view",
    "load_frame": "host.frame_file",
    "load_scene": "host.scenes.scenes",
    "make_frame": "host.pipeline",
    "make_frames": "host.pipeline",
    "read_cloud": "host.files.readers",
    "save_frame": "host.frame_file",
    "splat_radii": "host.cloud.spacing",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that importing the package costs nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"splatline.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
