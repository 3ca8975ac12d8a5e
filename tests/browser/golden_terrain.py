"""The built-in terrain as golden draws it, apart from any server."""

from functools import cache

from splatline.contract.presets import PRESETS
from splatline.host.scenes.scenes import load_scene
from splatline.view.camera import Camera
from splatline.view.draw import Settings, draw
from splatline.view.live_cloud import live_cloud


@cache
def terrain():
    return live_cloud(load_scene("terrain").cloud)


def golden(settings, size):
    """Return what golden draws with the camera and settings of a message, as a drawing."""
    camera = Camera(**{**settings["camera"], "target": tuple(settings["camera"]["target"])})
    background = tuple(byte / 255 for byte in bytes.fromhex(settings["background"][1:]))
    drawn_with = Settings(
        preset=PRESETS[settings["preset"]],
        quality=settings["quality"],
        samples=settings["samples"],
        lights=settings["lights"],
        background=background,
    )
    return draw(terrain(), camera, size, drawn_with)
