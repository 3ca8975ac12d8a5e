"""The frames of the standalone bench: a few points of a built-in scene from two sides."""

from __future__ import annotations

import dataclasses

from splatline.contract.config import EngineConfig
from splatline.contract.frame import Frame
from splatline.host import fit_view, load_scene, make_frames, splat_radii

__all__ = ["bench_frames"]

EVERY = 4000
"""One point of so many is drawn."""

SIZE = (32, 24)
"""Width and height of the image in pixels, so that the window of sixteen lines slides."""

TURN = 100.0
"""Degrees between the two views."""


def bench_frames(config: EngineConfig) -> list[Frame]:
    """Return two frames of an engine's configuration: the scene ``knot``, thinned, from two sides.

    Both have the same range of depths, so that the second can be drawn over the first.
    """
    scene = load_scene("knot")
    arrays = ("positions", "normals", "colours", "two_sided")
    few = {name: getattr(scene.cloud, name)[::EVERY] for name in arrays}
    cloud = dataclasses.replace(scene.cloud, **few)
    radii = splat_radii(cloud)
    frames: list[Frame] = []
    for turn in (0.0, TURN):
        orbit = (scene.orbit[0] + turn, scene.orbit[1])
        view = fit_view(cloud, orbit=orbit, fov=scene.fov, up=scene.up, size=SIZE)
        depths = tuple(frames[0].counts["depth_range"]) if frames else None
        frames += make_frames(cloud, view, radii=radii, config=config, depth_range=depths)
    return frames
