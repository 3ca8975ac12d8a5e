"""The scene ``knot``: generated closed surfaces, with every direction of normal."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud

from .patches import Patch, sample

__all__ = ["POINTS", "knot_cloud", "knot_patches"]

POINTS = 200_000
"""Points of all surfaces together."""

_Floats = npt.NDArray[np.float64]
_Curve = Callable[[_Floats], tuple[_Floats, _Floats, _Floats]]
_Part = tuple[_Floats, _Floats, npt.NDArray[np.uint8]]  # positions, normals, colours

# Chosen to differ with three bits a channel, lit and in shade.
CORAL, CREAM = (255, 90, 60), (255, 236, 200)
TEAL, NAVY, GOLD = (40, 190, 180), (60, 90, 210), (255, 200, 40)

TUBE = 0.44
"""Radius of the knot's tube; its curve lies on a torus of radii 2 and 1."""

STRIPES, TURNS = 3, 24
"""Stripes around the tube, and stripes along its length."""

RING, RING_TUBE = 0.84, 0.16
"""Radii of a ring: its circle, and its tube."""

HANG = 0.18
"""Distance of a ring's centre from the curve on which it hangs."""

BALL = 0.48
"""Radius of the sphere."""


def knot_cloud() -> Cloud:
    """Return a striped trefoil knot with three rings hung on it, around a sphere.

    The points are spread evenly; see :func:`splatline.host.scenes.patches.sample`.
    """
    return sample(knot_patches(), POINTS, "knot")


def knot_patches() -> list[Patch]:
    """Return the surfaces: knot, three rings and sphere."""
    length = float(_arc(_trefoil)[1][-1])
    ring_area = 4.0 * math.pi**2 * RING * RING_TUBE
    return [
        Patch(2.0 * math.pi * TUBE * length, _knot),
        *[Patch(ring_area, _ring_at(2.0 * math.pi * k / 3.0)) for k in range(3)],
        Patch(4.0 * math.pi * BALL**2, _ball),
    ]


def _knot(along: _Floats, share: _Floats) -> _Part:
    """Return points of the knot, in two colours that wind round it."""
    positions, normals, around = _tube(_trefoil, TUBE, along, share)
    # The Frenet frame rotates about the curve, fast where the curve is nearly straight. Evenly
    # wound stripes must not rotate with it, and must meet themselves after the whole length.
    lengths, twist = _frame_twist(_trefoil)
    untwist = np.interp(along, lengths, twist)
    close = np.rint(STRIPES * twist[-1]) - STRIPES * twist[-1]
    phase = (STRIPES * (around + untwist) + (TURNS + close) * along) % 1.0
    return positions, normals, np.where((phase < 0.3)[:, None], CREAM, CORAL).astype(np.uint8)


def _frame_twist(curve: _Curve) -> tuple[_Floats, _Floats]:
    """Return shares of a curve's length, and the Frenet frame's rotations up to each.

    The frame's rate of rotation about the tangent is the torsion, -dB/ds . N.
    """
    t, arc = _arc(curve)
    _, first, second = curve(t)
    binormal = np.cross(first, second)
    binormal /= np.linalg.norm(binormal, axis=-1, keepdims=True)
    tangent = first / np.linalg.norm(first, axis=-1, keepdims=True)
    normal = np.cross(binormal, tangent)
    steps = -np.sum(np.diff(binormal, axis=0) * 0.5 * (normal[1:] + normal[:-1]), axis=-1)
    return arc / arc[-1], np.concatenate([[0.0], np.cumsum(steps)]) / (2.0 * math.pi)


def _ring_at(t: float) -> Callable[[_Floats, _Floats], _Part]:
    """Return the surface of a ring about the trefoil's curve at ``t``."""
    centre, tangent, _ = (value[0] for value in _trefoil(np.array([t])))
    tangent = tangent / np.linalg.norm(tangent)
    outward = centre / np.linalg.norm(centre)
    side = np.cross(tangent, outward)  # at the lobes the curve runs across its radius
    axes = np.stack([outward, side, tangent])
    middle = centre + HANG * outward

    def ring(along: _Floats, share: _Floats) -> _Part:
        positions, normals, _ = _tube(_circle, RING_TUBE, along, share)
        return positions @ axes + middle, normals @ axes, _plain(GOLD, len(along))

    return ring


def _ball(along: _Floats, share: _Floats) -> _Part:
    """Return points of the sphere, in two colours by octant."""
    height = 1.0 - 2.0 * along
    angle = 2.0 * math.pi * share
    wide = np.sqrt(1.0 - height**2)
    normals = np.stack([wide * np.cos(angle), wide * np.sin(angle), height], axis=-1)
    odd = np.prod(np.sign(normals), axis=1) > 0.0
    return BALL * normals, normals, np.where(odd[:, None], TEAL, NAVY).astype(np.uint8)


def _plain(colour: tuple[int, int, int], count: int) -> npt.NDArray[np.uint8]:
    return np.tile(np.array(colour, np.uint8), (count, 1))


def _trefoil(t: _Floats) -> tuple[_Floats, _Floats, _Floats]:
    """Return position, first and second derivative of the torus knot (2, 3) at t in 0..2 pi."""
    (c2, s2), (c3, s3) = (np.cos(2 * t), np.sin(2 * t)), (np.cos(3 * t), np.sin(3 * t))
    wide, wide1, wide2 = 2.0 + c3, -3.0 * s3, -9.0 * c3
    return (
        np.stack([wide * c2, wide * s2, s3], -1),
        np.stack([wide1 * c2 - 2 * wide * s2, wide1 * s2 + 2 * wide * c2, 3.0 * c3], -1),
        np.stack(
            [
                wide2 * c2 - 4 * wide1 * s2 - 4 * wide * c2,
                wide2 * s2 + 4 * wide1 * c2 - 4 * wide * s2,
                -9.0 * s3,
            ],
            -1,
        ),
    )


def _circle(t: _Floats) -> tuple[_Floats, _Floats, _Floats]:
    """Return position, first and second derivative of a ring's circle at t in 0..2 pi."""
    c, s, zero = RING * np.cos(t), RING * np.sin(t), np.zeros_like(t)
    return np.stack([c, s, zero], -1), np.stack([-s, c, zero], -1), np.stack([-c, -s, zero], -1)


def _arc(curve: _Curve) -> tuple[_Floats, _Floats]:
    """Return parameters in 0..2 pi, and the length of the curve up to each."""
    t = np.linspace(0.0, 2.0 * math.pi, 8193)
    speed = np.linalg.norm(curve(t)[1], axis=-1)
    steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(t)
    return t, np.concatenate([[0.0], np.cumsum(steps)])


def _tube(
    curve: _Curve, radius: float, along: _Floats, share: _Floats
) -> tuple[_Floats, _Floats, _Floats]:
    """Return points of a tube about a closed curve.

    With the curve's Frenet frame and its curvature k, the tube's point at arc length s and angle
    a, c(s) + radius (cos a N + sin a B), has the area element radius (1 - k radius cos a) ds da.
    Its integral over a full turn does not depend on s, so even arc lengths are even in area, and
    the share of a turn up to a is (a - k radius sin a) / 2 pi: Kepler's equation.

    Parameters
    ----------
    along
        Shares in 0..1 of the tube's length.
    share
        Shares in 0..1 of the area about the curve there.

    Returns
    -------
    positions, normals
        Shape (count, 3).
    around
        Shares in 0..1 of the circumference.
    """
    t, arc = _arc(curve)
    centre, first, second = curve(np.interp(along * arc[-1], arc, t))
    speed = np.linalg.norm(first, axis=-1, keepdims=True)
    tangent = first / speed
    bend = second - tangent * np.sum(second * tangent, axis=-1, keepdims=True)
    size = np.linalg.norm(bend, axis=-1, keepdims=True)  # k speed^2
    normal = bend / size
    binormal = np.cross(tangent, normal)

    pinch = (size / speed**2)[:, 0] * radius  # k radius, below 1: the tube does not fold
    mean = 2.0 * math.pi * share
    angle = mean
    for _ in range(20):  # Newton; k radius stays below 0.6 here, so it converges at once
        excess = angle - pinch * np.sin(angle) - mean
        angle = angle - excess / (1.0 - pinch * np.cos(angle))
    out: _Floats = np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * binormal
    positions: _Floats = centre + radius * out
    return positions, out, angle / (2.0 * math.pi)
