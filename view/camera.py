"""A camera on an orbit: it looks at a target, and turns about it."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.cloud.upward import upward_of
from splatline.host.visibility.look_at import look_at
from splatline.host.visibility.view import View, fit_view, focal_length, orbit_axes

__all__ = ["Camera", "fit_camera"]

MOST_ELEVATION = 90.0
"""Degrees; the eye does not turn over the top."""

DIGITS = 6
"""Digits of a target's coordinates behind the first one of the distance."""


@dataclass(frozen=True)
class Camera:
    """A camera that looks at a target from an orbit about it.

    Parameters
    ----------
    target
        The point in the middle of the image, in the file's own coordinates.
    distance
        From the eye to the target, above 0, in the cloud's unit.
    azimuth, elevation
        Of the eye, in degrees, about the up axis; see ``fit_view``.
    up
        The cloud's axis that points up.
    fov
        Angle that the image's shorter side spans, in degrees.
    """

    target: tuple[float, float, float]
    distance: float
    azimuth: float = 30.0
    elevation: float = 20.0
    up: str = "y"
    fov: float = 35.0

    @property
    def orbit(self) -> tuple[float, float]:
        """Azimuth and elevation."""
        return self.azimuth, self.elevation

    @property
    def upward(self) -> str | None:
        """The axis up if the camera looks down or is level; else None."""
        return upward_of(self.orbit, self.up)

    def view(self, cloud: Cloud, size: tuple[int, int]) -> View:
        """Return what the camera sees of a cloud, on an image of a size in pixels.

        It is bit for bit the view of ``splatline render`` with the same ``--target``,
        ``--distance``, ``--orbit``, ``--up``, ``--fov`` and ``--size``.
        """
        target = np.asarray(self.target, np.float64) - cloud.origin
        return look_at(target, self.distance, orbit=self.orbit, fov=self.fov, size=size, up=self.up)

    def rounded(self) -> Camera:
        """Return the camera with few digits, whose numbers a command line holds exactly.

        Angles are multiples of 0.01 degrees, the distance has nine digits, and the target is
        rounded to a millionth of the distance or less: a small part of a pixel.
        """
        size = math.floor(math.log10(self.distance))
        x, y, z = (round(value, DIGITS - size) for value in self.target)
        return dataclasses.replace(
            self,
            target=(x + 0.0, y + 0.0, z + 0.0),  # no minus before a zero
            distance=round(self.distance, 8 - size),
            azimuth=round(self.azimuth, 2) + 0.0,
            elevation=round(self.elevation, 2) + 0.0,
        )

    def turned(self, azimuth: float, elevation: float) -> Camera:
        """Return the camera turned about its target, by angles in degrees."""
        most = MOST_ELEVATION
        return dataclasses.replace(
            self,
            azimuth=(self.azimuth + azimuth + 180.0) % 360.0 - 180.0,
            elevation=min(max(self.elevation + elevation, -most), most),
        )

    def panned(self, right: float, down: float, size: tuple[int, int]) -> Camera:
        """Return the camera moved so that the target's plane follows the hand.

        Parameters
        ----------
        right, down
            Pixels by which the picture moves.
        size
            Width and height of the image in pixels.
        """
        unit = self.distance / focal_length(size, self.fov)
        return self._moved(-right * unit, -down * unit)

    def zoomed(self, factor: float, at: tuple[float, float], size: tuple[int, int]) -> Camera:
        """Return the camera nearer to its target or farther, about a pixel.

        Parameters
        ----------
        factor
            Of the distance: below 1 is nearer.
        at
            Column and line of the image below which the target's plane stays.
        size
            Width and height of the image in pixels.
        """
        unit = self.distance / focal_length(size, self.fov) * (1.0 - factor)
        moved = self._moved((at[0] - 0.5 * size[0]) * unit, (at[1] - 0.5 * size[1]) * unit)
        return dataclasses.replace(moved, distance=self.distance * factor)

    def point_at(
        self, at: tuple[float, float], depth: float, size: tuple[int, int]
    ) -> tuple[float, float, float]:
        """Return the point seen at a pixel, in the file's own coordinates.

        Parameters
        ----------
        at
            Column and line of the image.
        depth
            Distance along the view, in the cloud's unit.
        size
            Width and height of the image in pixels.
        """
        focal = focal_length(size, self.fov)
        right = (at[0] - 0.5 * size[0]) * depth / focal
        down = (at[1] - 0.5 * size[1]) * depth / focal
        offset = np.array([right, down, depth - self.distance])
        return _triple(np.asarray(self.target) + offset @ orbit_axes(self.orbit, self.up))

    def looking_at(self, target: tuple[float, float, float]) -> Camera:
        """Return the camera with another target, at the same distance and orbit."""
        return dataclasses.replace(self, target=target)

    def _moved(self, right: float, down: float) -> Camera:
        """Return the camera moved in the image's plane, by lengths in the cloud's unit."""
        axes = orbit_axes(self.orbit, self.up)
        target = np.asarray(self.target) + right * axes[0] + down * axes[1]
        return dataclasses.replace(self, target=_triple(target))


def fit_camera(
    cloud: Cloud,
    radii: npt.NDArray[np.float64] | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    **options: Any,
) -> Camera:
    """Return the camera that sees a cloud as ``fit_view`` does.

    Its target lies on the view's axis, as far away as the middle of the cloud.

    Parameters
    ----------
    cloud, radii, size
        As of ``fit_view``.
    **options
        ``orbit``, ``fov`` and ``up`` of ``fit_view``.
    """
    view = fit_view(cloud, size=size, radii=radii, **options)
    positions = cloud.positions
    middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    distance = float((middle - view.eye) @ view.axes[2])
    target = _triple(view.eye + distance * view.axes[2] + cloud.origin)
    azimuth, elevation = options.pop("orbit", (30.0, 20.0))
    return Camera(target, distance, azimuth, elevation, **options)


def _triple(point: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    """Return a point as three floats."""
    x, y, z = map(float, point)
    return x, y, z
