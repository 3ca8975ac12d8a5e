"""A perspective view: the eye, and the image that it sees."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.host.cloud.cloud import Cloud

from .reach import measure_reach

__all__ = ["LARGEST", "View", "check_camera", "fit_view", "orbit_axes"]

LARGEST = float(1 << 24)
"""Pixels beyond which a coordinate is far outside every image; exact in float32."""

MARGIN = 1.06
"""The image is this many times as large as the points need."""

DEEPEST = 0.1
"""The eye stays away from a cloud by at least this share of its depth, divided by the width of the
image at distance 1: by a sixth of its depth for a field of view of 35 degrees. Else a line that
points at the eye would be seen as its nearest point."""

DEEPEST_WITH_DISCS = 0.3
"""The same at most, to keep discs narrower than ``WIDEST`` of the image."""

WIDEST = 0.25
"""Share of the image's shorter side."""

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
    """Return the view from a direction in which a cloud just fits the image.

    The points keep a small margin, which holds the discs of a dense cloud; if the discs are larger,
    they touch the border. The eye keeps away from a cloud that is long in its direction.

    Parameters
    ----------
    cloud
        The cloud; at least one point.
    orbit
        Azimuth and elevation of the eye in degrees, about the up axis.
    fov
        Angle that the image's shorter side spans, in degrees, between 0 and 180.
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
    focal = 0.5 * min(width, height) / math.tan(math.radians(fov) / 2.0)
    eye, near = _fit_eye(cloud.positions, axes, (width / focal, height / focal), radii)
    return View(eye, axes, focal * zoom, width, height, near)


def check_camera(
    orbit: tuple[float, float], fov: float, size: tuple[int, int], up: str, zoom: float
) -> None:
    """Raise ``InputError`` if a parameter of :func:`fit_view` is out of its range."""
    width, height = size
    if not 0.0 < fov < 180.0:
        raise InputError(f"the field of view must lie between 0 and 180 degrees, not {fov:g}")
    if width < 1 or height < 1:
        raise InputError(f"the image must have at least one pixel, not {width}x{height}")
    if up not in UP_AXES:
        raise InputError(f"the up axis must be one of {', '.join(UP_AXES)}, not {up!r}")
    if not (math.isfinite(zoom) and zoom > 0.0):
        raise InputError(f"the zoom must be above 0, not {zoom:g}")
    if not all(math.isfinite(angle) for angle in orbit):
        raise InputError(f"the orbit must be two finite angles, not {orbit}")


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


def _fit_eye(
    positions: npt.NDArray[np.float64],
    axes: npt.NDArray[np.float64],
    spans: tuple[float, float],
    radii: npt.NDArray[np.float64] | None,
) -> tuple[npt.NDArray[np.float64], float]:
    """Return the nearest eye that sees every point with a small margin, and a near distance.

    Each side of the image is a plane through the eye, which the furthest point in the plane's
    direction touches. The two planes of an axis meet at the nearest possible eye. This is exact for
    a perspective view, unlike fitting a bounding sphere. Discs are taken as spheres, which have no
    margin.

    Points p obey |p - e| <= slope * (z - e_z) on both sides of an axis, for an eye e.
    """
    of_discs = 0.5 * spans[0], 0.5 * spans[1]
    of_points = of_discs[0] / MARGIN, of_discs[1] / MARGIN
    widest = WIDEST * min(spans)
    reach = measure_reach(positions, radii, axes, of_points, of_discs, 2.0 / widest)
    # Of each axis its planes: their slope, and how far the cloud reaches beyond either.
    sides = [[(slope, *map(float, reach.points[axis]))] for axis, slope in enumerate(of_points)]
    if radii is not None:
        for axis, slope in enumerate(of_discs):
            sides[axis].append((slope, *map(float, reach.discs[axis])))
    distances = [
        -(upper + lower) / (slope + other)
        for pairs in sides
        for slope, upper, _ in pairs
        for other, _, lower in pairs
    ]
    extent = float((reach.most - reach.least).max())
    nearest = float(reach.least[2])
    depth = float(reach.most[2]) - nearest
    room = max(1e-3 * extent, DEEPEST * depth / min(spans))
    if radii is not None:
        room = max(room, min(nearest - reach.nearest_disc, DEEPEST_WITH_DISCS * depth / min(spans)))
    eye = np.zeros(3)
    eye[2] = min(*distances, nearest - room)
    if extent == 0.0:  # a single position, seen from a distance of one unit
        eye[2] = nearest - 1.0 if radii is None else min(eye[2], nearest - 1.0)
    for axis, pairs in enumerate(sides):
        least = max(upper + slope * eye[2] for slope, upper, _ in pairs)
        most = min(-(lower + slope * eye[2]) for slope, _, lower in pairs)
        middle = 0.5 * (pairs[0][1] - pairs[0][2])
        eye[axis] = min(max(middle, least), most)
    near = max((nearest - eye[2]) * 1e-3, float(np.finfo(np.float64).smallest_subnormal))
    return eye @ axes, near
