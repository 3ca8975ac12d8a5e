"""A view that looks at a point from a distance."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .view import View, check_camera, focal_length, orbit_axes

__all__ = ["NEAR", "look_at"]

NEAR = 1e-3
"""Nearest distance that is drawn, as a share of the distance to the point that is looked at."""


def look_at(
    target: npt.ArrayLike,
    distance: float,
    *,
    orbit: tuple[float, float] = (30.0, 20.0),
    fov: float = 35.0,
    size: tuple[int, int] = (512, 512),
    up: str = "y",
    zoom: float = 1.0,
) -> View:
    """Return the view whose axis meets a point at a distance from the eye.

    Parameters
    ----------
    target
        The point in the middle of the image: shape (3,), in the coordinates of a cloud's positions
        (relative to its origin).
    distance
        From the eye to the point, above 0, in the cloud's unit.
    orbit, fov, size, up, zoom
        As of :func:`fit_view`.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    """
    check_camera(orbit, fov, size, up, zoom)
    point = np.asarray(target, np.float64)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InputError(f"the target must be three finite coordinates, not {target!r}")
    if not (math.isfinite(distance) and distance > 0.0):
        raise InputError(f"the distance must be above 0, not {distance:g}")
    width, height = size
    axes = orbit_axes(orbit, up)
    eye = point - distance * axes[2]
    return View(eye, axes, focal_length(size, fov) * zoom, width, height, NEAR * distance)
