"""A perspective view: the eye, and the image that it sees."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

from .fit_eye import fit_eye

__all__ = [
    "LARGEST",
    "UP_AXES",
    "View",
    "check_camera",
    "check_view",
    "fit_view",
    "focal_length",
    "orbit_axes",
]

LARGEST = float(1 << 24)
"""Pixels beyond which a coordinate is far outside every image; exact in float32."""

FARTHEST = 1e100
"""Coordinates and focal lengths beyond it have no square."""

SHORTEST = 1e-6
"""Focal length in pixels below which any cloud is far less than a pixel."""

NARROWEST = 1e-5
"""Field of view in degrees; the cosine of a much smaller one is 1."""

UP_AXES = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True)
class View:
    """A pinhole camera in the coordinates of a cloud's positions (relative to its origin).

    A point at camera coordinates (x, y, z), z along the view, lands on the image at
    ``column = middle[0] + focal * x / z`` and ``line = middle[1] + focal * y / z``: x runs to the
    right and y down. The pixel at column i and line j covers [i, i + 1) x [j, j + 1).

    Parameters
    ----------
    eye
        Shape (3,), float64: the centre of projection.
    axes
        Shape (3, 3), float64, orthonormal rows: the directions right, down and forward.
    focal
        Focal length in pixels.
    width, height
        Size of the image in pixels.
    near
        Nearest distance along the view that is drawn, above 0.
    shift
        Pixels right and down from the image's middle to the view's axis.
    """

    eye: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]
    focal: float
    width: int
    height: int
    near: float
    shift: tuple[float, float] = (0.0, 0.0)

    @property
    def middle(self) -> tuple[float, float]:
        """Column and line at which the view's axis meets the image."""
        return 0.5 * self.width + self.shift[0], 0.5 * self.height + self.shift[1]


def fit_view(
    cloud: Cloud,
    *,
    orbit: tuple[float, float] = (30.0, 20.0),
    fov: float = 35.0,
    size: tuple[int, int] = (512, 512),
    up: str = "y",
    zoom: float = 1.0,
    radii: npt.NDArray[np.float64] | None = None,
) -> View:
    """Return the view from a direction in which a cloud just fits the image, in its middle.

    The points keep a small margin, which holds the discs of a dense cloud; if the discs are larger,
    they touch the border. The eye keeps away from a cloud that is long in its direction.

    Parameters
    ----------
    cloud
        The cloud; at least one point.
    orbit
        Azimuth and elevation of the eye in degrees, about the up axis.
    fov
        Angle that the image's shorter side spans, in degrees, from 1e-5 to below 180.
    size
        Width and height of the image in pixels.
    up
        The cloud's axis that points up: x, y, z, or one of these with a minus.
    zoom
        Magnification about the middle of the image; 1 fits the cloud.
    radii
        Radius of each point's disc: shape (n,). None: only the points are fitted.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    """
    check_camera(orbit, fov, size, up, zoom)
    width, height = size
    axes = orbit_axes(orbit, up)
    focal = focal_length(size, fov)
    eye, near = fit_eye(cloud.positions, axes, (width / focal, height / focal), radii)
    return View(eye, axes, focal * zoom, width, height, near)


def check_camera(
    orbit: tuple[float, float], fov: float, size: tuple[int, int], up: str, zoom: float
) -> None:
    """Raise ``InputError`` if a parameter of :func:`fit_view` is out of its range."""
    width, height = size
    if not NARROWEST <= fov < 180.0:
        raise InputError(
            f"the field of view must be at least {NARROWEST:g} and below 180 degrees, not {fov:g}"
        )
    if width < 1 or height < 1:
        raise InputError(f"the image must have at least one pixel, not {width}x{height}")
    if up not in UP_AXES:
        raise InputError(f"the up axis must be one of {', '.join(UP_AXES)}, not {up!r}")
    if not (math.isfinite(zoom) and zoom > 0.0):
        raise InputError(f"the zoom must be above 0, not {zoom:g}")
    if not SHORTEST <= focal_length(size, fov) * zoom < FARTHEST:
        raise InputError(
            f"a zoom of {zoom:g} does not go with a field of view of {fov:g} degrees; give numbers"
            " nearer to 1 and 35"
        )
    if not all(math.isfinite(angle) for angle in orbit):
        raise InputError(f"the orbit must be two finite angles, not {orbit}")


def check_view(view: View) -> None:
    """Raise ``InputError`` unless a view's numbers are finite and its lengths above 0."""
    numbers = (*view.eye, *np.ravel(view.axes), *view.shift)
    if not all(abs(number) < FARTHEST for number in numbers):
        raise InputError("the view's eye, axes and shift must be numbers below 1e100")
    if not SHORTEST <= view.focal < FARTHEST:
        raise InputError(
            f"the view's focal length must be {SHORTEST:g} to {FARTHEST:g} pixels, not"
            f" {view.focal:g}"
        )
    if not 0.0 < view.near < FARTHEST:
        raise InputError(f"the view's nearest distance must be above 0, not {view.near:g}")


def focal_length(size: tuple[int, int], fov: float) -> float:
    """Return the focal length in pixels at which an image's shorter side spans an angle.

    Parameters
    ----------
    size
        Width and height of the image in pixels.
    fov
        The angle in degrees.
    """
    return 0.5 * min(size) / math.tan(math.radians(fov) / 2.0)


def orbit_axes(orbit: tuple[float, float], up: str) -> npt.NDArray[np.float64]:
    """Return the right, down and forward axes of an eye that looks in from an orbit.

    Parameters
    ----------
    orbit
        Azimuth and elevation in degrees.
    up
        One of ``UP_AXES``.

    Returns
    -------
    numpy.ndarray
        Shape (3, 3), float64, orthonormal rows.
    """
    upward = np.asarray(UP_AXES[up], np.float64)
    azimuth, elevation = np.radians(orbit)
    # At azimuth 0 the eye stands on the axis that follows up's in cyclic order (z for y up).
    front = np.roll(np.abs(upward), 1)
    side = np.cross(upward, front)
    outward = np.cos(elevation) * (np.cos(azimuth) * front + np.sin(azimuth) * side)
    outward = outward + np.sin(elevation) * upward
    above = -np.sin(elevation) * (np.cos(azimuth) * front + np.sin(azimuth) * side)
    above = above + np.cos(elevation) * upward
    return np.stack([np.cross(above, outward), -above, -outward])
