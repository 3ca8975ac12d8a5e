"""A disc on the image: its place and size, its normal as the eye sees it, and its shade."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np

from splatline.host.shading.normal_levels import quantise

from .cull import faces_away, in_camera, lies_outside, misses_centre
from .skips import REASONS
from .trim import trim
from .view import LARGEST

__all__ = ["Image", "project_disc", "shade_of", "turn_to_eye"]

STEEPEST = 1e-6
"""Least cosine between a normal and the ray that slopes are computed for: they stay finite."""

OUTSIDE, FACING_AWAY = REASONS["outside"], REASONS["facing_away"]
NO_PIXEL = REASONS["no_pixel"]


class Image(NamedTuple):
    """A disc on the image.

    Parameters
    ----------
    column, line
        Its centre, in pixels.
    radius
        In pixels, seen face on. These three are rounded to float32.
    a, b, z
        Its centre in camera coordinates: x / z, y / z and z.
    """

    column: float
    line: float
    radius: float
    a: float
    b: float
    z: float


NOWHERE = Image(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@nb.njit(inline="always")
def project_disc(
    x: float, y: float, z: float, radius: float, camera: Any, may_miss: bool, at_border: bool
) -> tuple[int, Any]:
    """Return the reason to leave a disc out, or 0, and its image.

    Parameters
    ----------
    x, y, z, radius
        Its centre in camera coordinates, and its radius.
    camera
        The view.
    may_miss
        Whether it is left out if it covers no pixel's centre.
    at_border
        Whether it may lie outside of the image and is left out then.
    """
    if not z >= camera.near:
        return OUTSIDE, NOWHERE
    # Divided, not multiplied by 1 / z, which overflows where z is tiny.
    a = x / z
    b = y / z
    column = camera.middle_x + camera.focal * a
    line = camera.middle_y + camera.focal * b
    share = radius / z
    pixels = trim(share * camera.focal, camera.excess)
    if at_border and (
        lies_outside(column, a, pixels, share, camera.width)
        or lies_outside(line, b, pixels, share, camera.height)
    ):
        return OUTSIDE, NOWHERE
    if may_miss and pixels < 0.5 and misses_centre(column, line, pixels, a, b):
        return NO_PIXEL, NOWHERE
    if pixels > LARGEST:
        # The image is the same and nothing overflows. The axis of the view keeps its position.
        smaller = LARGEST / pixels
        column = camera.middle_x + (column - camera.middle_x) * smaller
        line = camera.middle_y + (line - camera.middle_y) * smaller
        pixels = LARGEST
    # As a splat holds it.
    column, line = np.float64(np.float32(column)), np.float64(np.float32(line))
    pixels = 0.5 * np.float64(np.float32(2.0 * pixels))
    return 0, Image(column, line, pixels, a, b, z)


@nb.njit(inline="always")
def turn_to_eye(
    normal: Any, two_sided: bool, thin: bool, image: Any, camera: Any, skips_backs: bool
) -> tuple[int, float, float, float, float]:
    """Return the reason to leave a disc out, or 0, and its normal, which is turned to the eye.

    Parameters
    ----------
    normal
        In the cloud's coordinates.
    two_sided
        Whether the normal's sign means nothing.
    thin
        Whether the point is on a curve or alone. If its normal is estimated, it means nothing, and
        the disc faces the eye.
    image
        The disc's.
    camera
        The view.
    skips_backs
        Whether a disc is left out that shows its back.

    Returns
    -------
    reason
        The reason, or 0.
    facing
        n . (a, b, 1), below 0.
    nx, ny, nz
        The normal in camera coordinates.
    """
    nx, ny, nz = in_camera(camera, normal[0], normal[1], normal[2])
    if thin and two_sided:
        away = 1.0 / math.sqrt(image.a * image.a + image.b * image.b + 1.0)
        nx, ny, nz = -image.a * away, -image.b * away, -away
    facing = nx * image.a + ny * image.b + nz
    reason = 0
    if facing > 0.0 and (two_sided or not skips_backs):
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    if skips_backs and faces_away(facing) and not two_sided:
        reason = FACING_AWAY
    return reason, min(facing, -STEEPEST), nx, ny, nz


@nb.njit(inline="always")
def shade_of(nx: float, ny: float, nz: float, facing: float, image: Any, shades: Any) -> int:
    """Return DIFFUSE and SPECULAR of a disc; see :func:`turn_to_eye` and ``project_loop.Look``."""
    # The eye sees a point near the image's border along a slant, so a front may have n_z >= 0. For
    # shading, such a normal counts as just grazing.
    towards = min(nz, -STEEPEST)
    levels = shades.shape[1]
    shade = shades[0, quantise(nx, towards, levels), quantise(ny, towards, levels)]
    # The table's viewer is on the axis. A highlight is as the true viewer sees it if the normal
    # turns along by half of the angle from his direction to the axis: n + ((n.v) e - (n.e) v) / 2.
    # v is the direction to the viewer, e the one against the axis.
    a, b = image.a, image.b
    half = 0.5 / math.sqrt(a * a + b * b + 1.0)
    mx, my = nx - half * a * nz, ny - half * b * nz
    mz = min(nz + half * (facing - nz), -STEEPEST)
    return shade | shades[1, quantise(mx, mz, levels), quantise(my, mz, levels)]
