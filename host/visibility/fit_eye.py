"""The nearest eye that sees a whole cloud, in the middle of its image."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .reach import Reach, measure_reach

__all__ = ["fit_eye"]

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

SAMPLE = 1 << 15
"""Points by which the middle of the image is found; all points correct it once."""

STEPS = 3
"""Steps with the sample."""

_Floats = npt.NDArray[np.float64]

_Planes = list[tuple[float, float, float]]


def fit_eye(
    positions: _Floats,
    axes: _Floats,
    spans: tuple[float, float],
    radii: _Floats | None,
) -> tuple[_Floats, float]:
    """Return the nearest eye that sees every point with a small margin, and a near distance.

    Each side of the image is a plane through the eye, which the furthest point in the plane's
    direction touches. The two planes of an axis meet at the nearest possible eye. This is exact for
    a perspective view, unlike fitting a bounding sphere. Discs are taken as spheres, which have no
    margin.

    On an axis that the points do not fill, narrower planes through the eye touch them. They span
    the least slope s with p - s d_p <= e and e <= q + s d_q for all points, for an eye at e and
    distances d. It is the largest (p - q) / (d_p + d_q). Dinkelbach's method finds it ("On
    nonlinear fractional programming", 1967): the two points that reach furthest beyond planes of
    one slope give the next slope.

    Parameters
    ----------
    positions
        Shape (n, 3), float64; n at least 1.
    axes
        Camera axes as rows: right, down and forward.
    spans
        Width and height of the image at distance 1.
    radii
        Radius of each point's disc: shape (n,). None: 0.

    Returns
    -------
    eye, near
        The eye: shape (3,); a distance along the view at which no point lies before it.
    """
    of_discs = 0.5 * spans[0], 0.5 * spans[1]
    of_points = of_discs[0] / MARGIN, of_discs[1] / MARGIN
    step = max(1, len(positions) // SAMPLE)
    few = positions[::step].copy(), None if radii is None else radii[::step]
    eye, slopes = np.zeros(3), of_points
    for points, discs in [few] * STEPS + [(positions, radii)]:
        reach = measure_reach(
            points, discs, axes, of_points, of_discs, 2.0 / (WIDEST * min(spans)), slopes
        )
        sides = [_planes(of_points, reach.points, axis) for axis in range(2)]
        if radii is not None:
            for axis, pairs in enumerate(sides):
                pairs += _planes(of_discs, reach.discs, axis)
        eye[2] = _forward(reach, sides, min(spans), radii is not None)
        slopes = _centre(reach, sides, eye)
    nearest = float(reach.least[2])
    near = max((nearest - eye[2]) * 1e-3, float(np.finfo(np.float64).smallest_subnormal))
    return eye @ axes, near


def _planes(slopes: tuple[float, float], reach: _Floats, axis: int) -> _Planes:
    """Return an axis's pair of planes: their slope, and how far the cloud reaches beyond either."""
    return [(slopes[axis], float(reach[axis, 0]), float(reach[axis, 1]))]


def _forward(reach: Reach, sides: list[_Planes], span: float, has_discs: bool) -> float:
    """Return the nearest eye's coordinate along the view; ``span`` is that of the shorter side."""
    distances = [
        -(upper + lower) / (slope + other)
        for pairs in sides
        for slope, upper, _ in pairs
        for other, _, lower in pairs
    ]
    extent = float((reach.most - reach.least).max())
    nearest = float(reach.least[2])
    depth = float(reach.most[2]) - nearest
    room = max(1e-3 * extent, DEEPEST * depth / span)
    if has_discs:
        room = max(room, min(nearest - reach.nearest_disc, DEEPEST_WITH_DISCS * depth / span))
    forward = min(*distances, nearest - room)
    if extent == 0.0:  # a single position, seen from a distance of one unit
        forward = min(forward, nearest - 1.0) if has_discs else nearest - 1.0
    return forward


def _centre(reach: Reach, sides: list[_Planes], eye: _Floats) -> tuple[float, float]:
    """Set an eye's coordinates right and down; return the next slopes of the planes that touch."""
    slopes = []
    for axis, pairs in enumerate(sides):
        least = max(upper + slope * eye[2] for slope, upper, _ in pairs)
        most = min(-(lower + slope * eye[2]) for slope, _, lower in pairs)
        (upper, behind), (lower, behind_lower) = reach.touched[axis]
        distance, lower_distance = behind - eye[2], behind_lower - eye[2]
        middle, slope = 0.5 * (upper + lower), 0.0
        if distance + lower_distance > 0.0:  # false if rounding leaves no distance
            slope = float((upper - lower) / (distance + lower_distance))
            middle = upper - slope * distance
        eye[axis] = min(max(middle, least), most)
        slopes.append(slope)
    return slopes[0], slopes[1]
