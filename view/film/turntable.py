"""A camera that goes once round a cloud, so that the cloud stays in the picture all the way."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.visibility.view import UP_AXES, check_camera
from splatline.view.camera import Camera

__all__ = ["fit_turntable", "turntable"]

MARGIN = 1.06
"""The image is this many times as large as the points need, as in ``fit_view``."""

ROOM = 0.05
"""The eye stays away from the cloud by at least this share of the cloud's reach along the view."""

_Floats = npt.NDArray[np.float64]


def turntable(camera: Camera, count: int) -> list[Camera]:
    """Return the cameras of one turn about the target, in even steps.

    The turn is whole after the last camera, whose successor is the first: played again and again,
    it does not halt.
    """
    return [camera.turned(360.0 * k / count, 0.0) for k in range(count)]


def fit_turntable(
    cloud: Cloud,
    radii: npt.NDArray[np.float64] | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    orbit: tuple[float, float] = (30.0, 20.0),
    fov: float = 35.0,
    up: str = "y",
    zoom: float = 1.0,
) -> Camera:
    """Return the camera at a distance from which a cloud fits the image from every azimuth.

    It looks at a point of the up axis through the middle of the cloud. The distance is the same for
    all azimuths, so the cloud does not grow and shrink as it turns.

    Parameters
    ----------
    cloud
        The points.
    radii
        Radii of their discs in the cloud's unit: shape (n,). None: 0.
    size, orbit, fov, up, zoom
        As of ``fit_view``.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    """
    check_camera(orbit, fov, size, up, zoom)
    upward = np.asarray(UP_AXES[up])
    low, high = cloud.positions.min(axis=0), cloud.positions.max(axis=0)
    middle = low + 0.5 * (high - low)
    offsets = cloud.positions - middle
    heights = offsets @ upward
    ring = _Ring(np.sqrt(np.maximum((offsets**2).sum(axis=1) - heights**2, 0.0)), heights)
    tilt = math.radians(min(max(orbit[1], -90.0), 90.0))
    half = math.tan(math.radians(fov) / 2.0)
    slopes = half * size[0] / min(size), half * size[1] / min(size)
    spheres = np.zeros(len(heights)) if radii is None else np.asarray(radii, np.float64)

    needs = [
        _needs(ring, np.zeros_like(spheres), (slopes[0] / MARGIN, slopes[1] / MARGIN), tilt),
        _needs(ring, spheres, slopes, tilt),
    ]
    above, below = (max(getattr(need, side) for need in needs) for side in ("above", "below"))
    rise = 0.5 * (above - below) * slopes[1] / max(math.cos(tilt), 1e-9)
    rise = min(max(rise, float(heights.min())), float(heights.max()))
    distance = max(need.distance(rise, tilt) for need in needs)
    reach = float((ring.radii * math.cos(tilt) + heights * math.sin(tilt)).max())
    nearest = reach - rise * math.sin(tilt)
    distance = max(
        distance, nearest + ROOM * abs(nearest), 1e-9 * (1.0 + float(np.abs(high).max()))
    )
    x, y, z = map(float, middle + rise * upward + cloud.origin)
    camera = Camera((x, y, z), distance, orbit[0], math.degrees(tilt), up, fov)
    narrowed = math.degrees(2.0 * math.atan(half / zoom))
    return dataclasses.replace(camera, fov=narrowed) if zoom != 1.0 else camera


class _Ring(NamedTuple):
    """The circles that points go round on, about the up axis: their radii and heights."""

    radii: _Floats
    heights: _Floats


class _Needs(NamedTuple):
    """How far away the eye must be at least, from a target in the middle of the cloud.

    Each is the largest over all points and azimuths: for the sides of the image, for its upper
    edge, and for its lower one.
    """

    aside: float
    above: float
    below: float
    slope: float

    def distance(self, rise: float, tilt: float) -> float:
        """Return the distance from a target that lies higher by ``rise``."""
        along, across = rise * math.sin(tilt), rise * math.cos(tilt) / self.slope
        return max(self.aside - along, self.above - along - across, self.below - along + across)


def _needs(ring: _Ring, spheres: _Floats, slopes: tuple[float, float], tilt: float) -> _Needs:
    """Return what spheres on their circles need.

    A sphere at (x, y, z) in camera axes about the target, z along the view, is inside the image
    seen from the distance d if ``|x| + r hypot(1, s) <= s (z + d)`` for the slope s of the side's
    plane, and so for y. On a circle of radius a at height h, ``x = a sin t``, ``y = a cos t sin e -
    h cos e`` and ``z = -a cos t cos e - h sin e`` for the tilt e. The largest d over all t follows,
    as ``A sin t + B cos t`` is at most ``hypot(A, B)``.
    """
    right, down = slopes
    sine, cosine = math.sin(tilt), math.cos(tilt)
    away = ring.heights * sine
    wide, tall = (spheres * math.hypot(1.0, slope) / slope for slope in slopes)
    aside = ring.radii * math.hypot(1.0 / right, cosine) + away + wide
    edge = ring.heights * cosine / down
    above = ring.radii * abs(cosine - sine / down) + away + edge + tall
    below = ring.radii * abs(cosine + sine / down) + away - edge + tall
    return _Needs(float(aside.max()), float(above.max()), float(below.max()), down)
