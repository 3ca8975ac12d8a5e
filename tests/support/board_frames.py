"""Small turntables for boards, and what a screen must show of them."""

import dataclasses

import numpy as np

from splatline.contract.presets import RGB24
from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.plots.figure import rgb_levels
from splatline.sim.golden.renderer import render

__all__ = ["BACKGROUND", "on_screen", "turntable"]

BACKGROUND = (23, 200, 31)


def turntable(number, *, size, every=1, scale=1.0, config=RGB24, name="knot"):
    """Return frames of a scene from all sides; ``every``: one point of so many is drawn."""
    scene = load_scene(name)
    arrays = {
        field.name: values[::every]
        for field in dataclasses.fields(scene.cloud)
        if isinstance(values := getattr(scene.cloud, field.name), np.ndarray) and len(values) > 3
    }
    cloud = dataclasses.replace(scene.cloud, **arrays)
    azimuth, elevation = scene.orbit
    return [
        make_frame(
            cloud,
            fit_view(
                cloud, orbit=(azimuth + 360 * n / number, elevation), fov=scene.fov, up=scene.up,
                size=size,
            ),
            radii=scale * splat_radii(scene.cloud)[::every],
            config=config,
        )
        for n in range(number)
    ]  # fmt: skip


def on_screen(frame, screen, background=BACKGROUND):
    """Return golden's picture of a frame in the middle of a screen: (lines, columns, 3), uint8."""
    picture = rgb_levels(render(frame).to_rgb(tuple(level / 255 for level in background)))
    shown = np.empty((screen[1], screen[0], 3), np.uint8)
    shown[:] = background
    columns, lines = min(frame.width, screen[0]), min(frame.height, screen[1])
    left, top = (screen[0] - columns) // 2, (screen[1] - lines) // 2
    x, y = (frame.width - columns) // 2, (frame.height - lines) // 2
    shown[top : top + lines, left : left + columns] = picture[y : y + lines, x : x + columns]
    return shown
