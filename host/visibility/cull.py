"""Culling: leaves out points that a view does not show, first whole blocks, then single points.

A block's test is a point's test of the worst point within the block's bounds. So it leaves out a
block only if each of its points would be left out.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb

from splatline.host.compiled_cache import cached_njit

from .skips import REASONS
from .view import View

__all__ = [
    "ROUNDING",
    "Camera",
    "cull_blocks",
    "faces_away",
    "from_eye",
    "in_camera",
    "lies_inside",
    "lies_outside",
    "misses_centre",
]

MARGIN = 1.5
"""Pixels by which a drawn footprint may reach beyond its true circle, as centres are rounded to a
whole pixel and diameters are rounded up."""

ROUNDING = 1e-3
"""Error in pixels of a position in float32."""

OUTSIDE = REASONS["outside"]
FACING_AWAY = REASONS["facing_away"]
NO_PIXEL = REASONS["no_pixel"]


class Camera(NamedTuple):
    """A view for compiled code: numbers alone, so that numba counts no references.

    Parameters
    ----------
    eye_x, eye_y, eye_z
        The centre of projection.
    right_x, right_y, right_z, down_x, down_y, down_z, ahead_x, ahead_y, ahead_z
        The directions right, down and forward.
    focal, middle_x, middle_y
        The focal length, and the column and line of the view's axis, in pixels.
    width, height
        Of the image in pixels.
    near
        Nearest distance along the view that is drawn.
    excess
        Share of its radius that a small disc loses; see ``trim``.
    """

    eye_x: float
    eye_y: float
    eye_z: float
    right_x: float
    right_y: float
    right_z: float
    down_x: float
    down_y: float
    down_z: float
    ahead_x: float
    ahead_y: float
    ahead_z: float
    focal: float
    middle_x: float
    middle_y: float
    width: int
    height: int
    near: float
    excess: float

    @classmethod
    def of(cls, view: View, cover: float = 1.0) -> Camera:
        """Return a view's camera; ``cover`` is that of the ``Discs``."""
        vectors = (*map(float, view.eye), *map(float, view.axes.ravel()))
        middle = map(float, view.middle)
        image = (float(view.focal), *middle, view.width, view.height, float(view.near))
        return cls._make((*vectors, *image, 1.0 - 1.0 / cover))


@nb.njit(inline="always")
def in_camera(camera: Any, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector in camera coordinates: right, down and forward."""
    return (
        camera.right_x * x + camera.right_y * y + camera.right_z * z,
        camera.down_x * x + camera.down_y * y + camera.down_z * z,
        camera.ahead_x * x + camera.ahead_y * y + camera.ahead_z * z,
    )


@nb.njit(inline="always")
def from_eye(camera: Any, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a position in camera coordinates."""
    return in_camera(camera, x - camera.eye_x, y - camera.eye_y, z - camera.eye_z)


@nb.njit(inline="always")
def lies_outside(position: float, slope: float, radius: float, share: float, size: int) -> bool:
    """Return whether a splat lies beyond one of the two borders of an axis.

    A disc of radius R at the depth z, seen at the slant a = x / z, reaches at most
    sqrt(1 + a^2) R / (z - R) from its centre. ``share`` is the part of z by which it comes nearer.

    Parameters
    ----------
    position
        Column (or line) of its centre, in pixels.
    slope
        Its slant a.
    radius
        R over z in pixels.
    share
        R over z.
    size
        Pixels of the image along the axis.
    """
    less = 1.0 - share if share < 1.0 else 0.0
    reach = radius * (1.0 + abs(slope)) + MARGIN
    return not (position * less > -reach and (position - size) * less < reach)


@nb.njit(error_model="numpy")
def lies_inside(bound: Any, middle: Any, camera: Any) -> bool:
    """Return whether all discs of a block lie in the image for certain.

    Parameters
    ----------
    bound
        The block's bounds.
    middle
        The middle of its sphere, in camera coordinates.
    camera
        The view.
    """
    x, y, z = middle
    size = bound.reach + bound.largest
    nearest = z - size
    if not nearest > max(size, camera.near):
        return False
    # A point of the sphere lies at most size (1 + |x / z|) / nearest from the middle's x / z.
    across, down = x / z, y / z
    reach = camera.focal * size / nearest
    right = reach * (1.0 + abs(across)) + MARGIN
    below = reach * (1.0 + abs(down)) + MARGIN
    column = camera.middle_x + camera.focal * across
    line = camera.middle_y + camera.focal * down
    return (
        column - right > 0.0
        and column + right < camera.width
        and line - below > 0.0
        and line + below < camera.height
    )


@nb.njit(inline="always")
def faces_away(facing: float) -> bool:
    """Return whether a surface shows its back; ``facing`` is n . (p - eye), up to a factor."""
    return facing >= 0.0


@nb.njit(inline="always")
def misses_centre(column: float, line: float, radius: float, a: float, b: float) -> bool:
    """Return whether a splat of less than half a pixel in radius misses every pixel's centre.

    A disc seen aslant, from x / z = a and y / z = b, reaches up to sqrt(1 + a^2 + b^2) times its
    radius (see ``footprint.conic``). The pixel that holds its own centre is the nearest.
    """
    dx, dy = math.floor(column) + 0.5 - column, math.floor(line) + 0.5 - line
    reach = radius + ROUNDING
    return dx * dx + dy * dy > reach * reach * (1.0 + a * a + b * b)


@cached_njit(parallel=True, error_model="numpy")
def cull_blocks(bounds: Any, camera: Any, rules: Any, status: Any) -> None:
    """Set for each block the reason to leave all of it out, or 0.

    Parameters
    ----------
    bounds
        Of the blocks, see ``host.visibility.block_index.BOUND``.
    camera
        The view.
    rules
        Whether each reason counts, by its number.
    status
        Set: shape (blocks,), uint8.
    """
    focal, near = camera.focal, camera.near
    middle_x, middle_y = camera.middle_x, camera.middle_y
    # The distance to the border that is further from the axis.
    wide = max(middle_x, camera.width - middle_x) + MARGIN
    high = max(middle_y, camera.height - middle_y) + MARGIN
    for block in nb.prange(len(bounds)):
        bound = bounds[block]
        dx = bound.centre[0] - camera.eye_x
        dy = bound.centre[1] - camera.eye_y
        dz = bound.centre[2] - camera.eye_z
        x, y, z = in_camera(camera, dx, dy, dz)
        reach, disc = bound.reach, focal * bound.largest
        status[block] = 0
        if z + reach < near or (
            rules[OUTSIDE]
            and (
                _beyond(x, z, focal, wide, reach, bound.largest)
                or _beyond(y, z, focal, high, reach, bound.largest)
            )
        ):
            status[block] = OUTSIDE
        elif rules[FACING_AWAY] and _all_face_away(dx, dy, dz, bound):
            status[block] = FACING_AWAY
        elif rules[NO_PIXEL] and not bound.thin and z - reach >= near:
            least = z - reach
            if _between_centres(x / z, least, middle_x, focal, reach, disc) or _between_centres(
                y / z, least, middle_y, focal, reach, disc
            ):
                status[block] = NO_PIXEL


@nb.njit
def _beyond(across: float, z: float, focal: float, away: float, reach: float, disc: float) -> bool:
    """Return whether a sphere and its discs lie beyond one of the two borders of an axis.

    A point beyond the right border, ``away`` pixels from the view's axis, has focal x - away z > 0.
    The sphere's centre must be further from that plane than its radius and a disc's together.
    """
    needed = (reach + disc) * math.sqrt(focal * focal + away * away)
    return focal * abs(across) - away * z > needed


@nb.njit
def _all_face_away(dx: float, dy: float, dz: float, bound: Any) -> bool:
    """Return whether every normal in the cone shows its back to the eye, from the whole sphere.

    From a point of the sphere the direction to the centre differs by at most the sphere's angular
    radius, and the normal by at most the cone's angle from its axis: together less than what the
    axis leans away.
    """
    distance = math.hypot(math.hypot(dx, dy), dz)
    if not (bound.sine <= 1.0 and bound.reach < distance):
        return False
    lean = (bound.axis[0] * dx + bound.axis[1] * dy + bound.axis[2] * dz) / distance
    # Sine and cosine of the two angles' sum, which must be below 90 degrees.
    sine, share = bound.sine, bound.reach / distance
    cosine, other = math.sqrt(1.0 - sine * sine), math.sqrt(1.0 - share * share)
    is_acute = cosine * other - sine * share > 0.0
    return is_acute and lean > sine * other + cosine * share + 1e-6


@nb.njit
def _between_centres(
    slope: float, least: float, middle: float, focal: float, reach: float, disc: float
) -> bool:
    """Return whether a sphere with all its discs lies between two columns (or lines) of centres.

    A point of the sphere has x / z within reach sqrt(1 + a^2) / z of the centre's a, and its disc
    reaches sqrt(1 + a'^2) times its radius (see ``footprint.conic``) from its own a'.
    """
    spread = reach * math.sqrt(1.0 + slope * slope) / least
    furthest = abs(slope) + spread
    span = focal * spread + disc * math.sqrt(1.0 + furthest * furthest) / least
    return span < 0.5 and _misses_pixels(middle + focal * slope, span)


@nb.njit(inline="always")
def _misses_pixels(centre: float, reach: float) -> bool:
    """Return whether no pixel's centre lies within ``reach`` of a column (or line)."""
    return math.ceil(centre - reach - ROUNDING - 0.5) > math.floor(centre + reach + ROUNDING - 0.5)
