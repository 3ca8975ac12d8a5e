"""A quick test of points, several at once: most points of a dense cloud are not seen.

It takes vector instructions and float32. It leaves out no point that the exact tests of
``project_loop`` would draw, as its margins cover the rounding. Where it says nothing, they decide.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from .block_index import BLOCK_POINTS
from .cull import ROUNDING, from_eye
from .skips import REASONS

__all__ = ["Blocks", "Points", "look_over", "middle_of", "stride_of"]

NEARBY = 2.0
"""Least distance of a block along the view, in its own radii: nearer ones are not tested, as
differences of float32 lose too many digits."""

MARGIN = 2.0**-20
"""Error in pixels of a position on the image, for each pixel of the image's size: 16 roundings."""

TURNED = 1e-5
"""Least n . (a, b, 1) of a surface that shows its back for certain."""

SLACK = 1.001
"""Factor on a disc's radius that covers the rounding of its conic."""

CROWDED = 0.5
"""Pixels between neighbours below which points are crowded: more than four of them a pixel."""

NO_PIXEL, FACING_AWAY = REASONS["no_pixel"], REASONS["facing_away"]
CROWDED_OUT = REASONS["crowded"]

# In the type of what is written, so that the loop is made of vectors.
_NO_PIXEL, _FACING_AWAY = np.uint8(REASONS["no_pixel"]), np.uint8(REASONS["facing_away"])
_KEPT = np.uint8(0)


class Points(NamedTuple):
    """The points of an index; see ``Index``."""

    discs: npt.NDArray[np.float32]
    two_sided: npt.NDArray[np.bool_]
    thin: npt.NDArray[np.bool_]
    material: npt.NDArray[np.uint8]
    positions: npt.NDArray[np.float64]
    radii: npt.NDArray[np.float64]


class Blocks(NamedTuple):
    """The blocks of an index.

    Parameters
    ----------
    bounds
        Bounds of every block; see ``BOUND``.
    visible
        Numbers of the blocks that were not culled.
    cuts
        Where each chunk begins in ``visible``, and the end: shape (CHUNKS + 1,).
    found
        What the quick test says of each of their points: the reason to leave it out, or 0.
    """

    bounds: npt.NDArray[Any]
    visible: npt.NDArray[np.int64]
    cuts: npt.NDArray[np.int64]
    found: npt.NDArray[np.uint8]


@nb.njit(parallel=True, cache=True, error_model="numpy")
def look_over(points: Any, blocks: Any, camera: Any, rules: Any, reasons: Any) -> None:
    """Set the reason to leave each point out, or 0, and count them by chunk.

    Parameters
    ----------
    points, blocks
        The index; ``blocks.found`` is set.
    camera
        The view.
    rules
        Whether each reason counts, by its number.
    reasons
        Set: points of each chunk by reason, those that are left of reason 0.
    """
    discs, two_sided, thin = points[0], points[1], points[2]
    bounds, visible, cuts, found = blocks
    for chunk in nb.prange(len(cuts) - 1):
        for number in range(cuts[chunk], cuts[chunk + 1]):
            bound = bounds[visible[number]]
            start = BLOCK_POINTS * visible[number]
            stop = min(start + BLOCK_POINTS, len(two_sided))
            stride = stride_of(bound, camera) if rules[CROWDED_OUT] else 1
            of_block = found[BLOCK_POINTS * number : BLOCK_POINTS * number + stop - start]
            of_block[:] = 0
            if rules[NO_PIXEL]:
                _test_block(
                    bound, discs, two_sided, thin, start, stop, camera, stride, rules[FACING_AWAY],
                    of_block,
                )  # fmt: skip
            if stride > 1:
                for i in range(len(of_block)):
                    of_block[i] = of_block[i] if i % stride == 0 else CROWDED_OUT
            # A pass for each reason takes vectors; one for all would not.
            for reason in (0, NO_PIXEL, FACING_AWAY, CROWDED_OUT):
                count = 0
                for i in range(len(of_block)):
                    count += of_block[i] == reason
                reasons[chunk, reason] += count


@nb.njit(error_model="numpy")
def stride_of(bound: Any, camera: Any) -> int:
    """Return the step between a block's points that are drawn, so that few share a pixel.

    A disc is as wide as the points are apart (``splat_radii``), so the mean radius tells the
    distance. Every k-th point along the curve is as evenly spread as all are.
    """
    # At the block's nearest point, where points are furthest apart on the image.
    nearest = max(middle_of(bound, camera)[2] - bound.reach, camera.near)
    apart = bound.mean * camera.focal / nearest
    if not 0.0 < apart < CROWDED:
        return 1
    return int(min((CROWDED / apart) ** 2, float(BLOCK_POINTS)))


@nb.njit(inline="always")
def middle_of(bound: Any, camera: Any) -> tuple[float, float, float]:
    """Return the middle of a block's bounding sphere in camera coordinates."""
    return from_eye(camera, bound.centre[0], bound.centre[1], bound.centre[2])


@nb.njit(error_model="numpy")
def _test_block(
    bound: Any,
    discs: Any,
    two_sided: Any,
    thin: Any,
    start: int,
    stop: int,
    camera: Any,
    stride: int,
    faces: bool,
    found: Any,
) -> None:
    """Set the reason to leave out each point of a block that the quick test knows.

    Parameters
    ----------
    bound
        The block's bounds.
    discs, two_sided, thin
        See ``Index``.
    start, stop
        The block's points.
    camera
        The view.
    stride
        See :func:`stride_of`; as many points become one.
    faces
        Whether points are left out that face away.
    found
        Set: shape (stop - start,), uint8.
    """
    x, y, z = middle_of(bound, camera)
    size, growth = bound.reach, math.sqrt(stride)
    is_far = z > max(NEARBY * size, camera.near + size)
    if not is_far or growth * bound.mean * camera.focal > 0.5 * z:
        return  # most of its discs cover a pixel's centre
    # In units of the distance, so that nothing over- or underflows in float32.
    _test(
        discs,
        two_sided,
        thin,
        start,
        stop,
        _row(camera.right_x, camera.right_y, camera.right_z),
        _row(camera.down_x, camera.down_y, camera.down_z),
        _row(camera.ahead_x, camera.ahead_y, camera.ahead_z),
        (np.float32(x / z), np.float32(y / z), np.float32(size / z)),
        (np.float32(camera.focal), np.float32(camera.middle_x), np.float32(camera.middle_y)),
        np.float32(growth * bound.largest * camera.focal / z),
        np.float32(ROUNDING + MARGIN * (camera.width + camera.height)),
        np.float32(TURNED if faces else np.inf),
        found,
    )


@nb.njit(inline="always")
def _row(x: float, y: float, z: float) -> tuple[np.float32, np.float32, np.float32]:
    """Return a direction in float32."""
    return np.float32(x), np.float32(y), np.float32(z)


@nb.njit(inline="always")
def _along(row: Any, x: float, y: float, z: float) -> float:
    """Return a vector's coordinate along a direction."""
    return row[0] * x + row[1] * y + row[2] * z


@nb.njit(error_model="numpy", fastmath={"contract", "nsz", "arcp"})
def _test(
    discs: Any,
    two_sided: Any,
    thin: Any,
    start: int,
    stop: int,
    right: Any,
    down: Any,
    ahead: Any,
    centre: Any,
    image: Any,
    radius: float,
    margin: float,
    turned: float,
    found: Any,
) -> None:
    """Test each point; values are float32, in units of the block's distance along the view.

    A disc whose conic is Q covers a centre at the offset d if Q(d) <= r^2. sqrt(Q) is a norm, so an
    error e of d changes it by at most sqrt(Q(e)), which is at most |e| sqrt(A + C).
    """
    half, one, two, slack = np.float32(0.5), np.float32(1.0), np.float32(2.0), np.float32(SLACK)
    for i in range(start, stop):
        dx, dy, dz = centre[2] * discs[0, i], centre[2] * discs[1, i], centre[2] * discs[2, i]
        nearer = one / (one + _along(ahead, dx, dy, dz))
        a = (centre[0] + _along(right, dx, dy, dz)) * nearer
        b = (centre[1] + _along(down, dx, dy, dz)) * nearer
        column, line = image[1] + image[0] * a, image[2] + image[0] * b
        u, v = np.floor(column) + half - column, np.floor(line) + half - line
        pixels = radius * discs[3, i] * nearer
        nx = _along(right, discs[4, i], discs[5, i], discs[6, i])
        ny = _along(down, discs[4, i], discs[5, i], discs[6, i])
        facing = nx * a + ny * b + _along(ahead, discs[4, i], discs[5, i], discs[6, i])
        # As in ``footprint.conic``, but for a factor of the square of ``facing``.
        sx, sy = nx, ny
        x_x, x_y = facing - a * sx, -a * sy
        y_x, y_y = -b * sx, facing - b * sy
        form_a = x_x * x_x + y_x * y_x + sx * sx
        form_b = x_x * x_y + y_x * y_y + sx * sy
        form_c = x_y * x_y + y_y * y_y + sy * sy
        square = form_a * u * u + two * form_b * u * v + form_c * v * v
        reach = (pixels * np.abs(facing) + margin * np.sqrt(form_a + form_c)) * slack
        missed = (pixels < half) & (square > reach * reach) & (not thin[i])
        away = (facing > turned) & (not two_sided[i])
        found[i - start] = _NO_PIXEL if missed else (_FACING_AWAY if away else _KEPT)
