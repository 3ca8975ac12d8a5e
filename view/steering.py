"""Motion of the camera when a person drags, turns the wheel or presses a key."""

from __future__ import annotations

import dataclasses
import math

from .camera import Camera
from .draw import Drawing
from .events import Event

__all__ = ["Seen", "steer"]

TURN = 180.0
"""Degrees of a drag over the shorter side of the picture."""

NEAREST, FARTHEST = 1e-5, 1e3
"""Distances that the camera keeps to, over that of the first picture; its target keeps within the
latter of the first one."""

Seen = tuple[Drawing, Camera]
"""A picture that a person saw, and the camera that it was drawn with."""


def steer(
    event: Event, camera: Camera, home: Camera, size: tuple[int, int], seen: Seen | None
) -> Camera:
    """Return the camera after an event that moves it.

    Parameters
    ----------
    event
        What a person did; its pixels are those of ``size``.
    camera, home
        The camera, and that of the first picture.
    size
        Width and height of the picture in pixels.
    seen
        The picture that was pointed at.
    """
    values = event.values
    if event.kind == "turn":
        a_pixel = TURN / min(size)
        moved = camera.turned(-values["dx"] * a_pixel, values["dy"] * a_pixel)
    elif event.kind == "pan":
        moved = camera.panned(values["dx"], values["dy"], size)
    elif event.kind == "zoom":
        wanted = _distance_near(camera.distance * values["factor"], home)
        moved = camera.zoomed(wanted / camera.distance, (values["x"], values["y"]), size)
    elif event.kind == "orbit":
        orbit = {"azimuth": values["azimuth"], "elevation": values["elevation"]}
        moved = dataclasses.replace(camera, **orbit).turned(0.0, 0.0)
    elif event.kind == "camera":
        wanted = _distance_near(values["distance"], home)
        moved = dataclasses.replace(camera, **{**values, "distance": wanted}).turned(0.0, 0.0)
    elif event.kind == "look":
        moved = _look(values["x"] / size[0], values["y"] / size[1], camera, seen)
    else:
        moved = home
    return moved if moved == camera else _kept_near(moved, home)


def _look(across: float, down: float, camera: Camera, seen: Seen | None) -> Camera:
    """Return the camera that looks at what was seen at a share of the picture's sides.

    It stays as it is if that was background.
    """
    if seen is None:
        return camera
    drawing, seen_by = seen
    size = drawing.view.width, drawing.view.height
    at = across * size[0], down * size[1]
    if not (0.0 <= at[0] < size[0] and 0.0 <= at[1] < size[1]):
        return camera
    depth = drawing.depth_at(math.floor(at[0]), math.floor(at[1]))
    return camera if depth is None else camera.looking_at(seen_by.point_at(at, depth, size))


def _distance_near(distance: float, home: Camera) -> float:
    """Return the distance that comes nearest to a wished one."""
    return min(max(distance, NEAREST * home.distance), FARTHEST * home.distance)


def _kept_near(camera: Camera, home: Camera) -> Camera:
    """Return a camera whose target is not lost far from the cloud."""
    reach = FARTHEST * home.distance
    x, y, z = (
        min(max(value, middle - reach), middle + reach)
        for value, middle in zip(camera.target, home.target, strict=True)
    )
    return dataclasses.replace(camera, target=(x, y, z))
