"""Stress cases of planes: slopes and depths at the ends of what a plane word holds."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.presets import PLANE
from splatline.host.cloud.cloud import Cloud
from splatline.host.files.assemble import Columns

from .camera import about_the_eye, one_disc
from .case import SOUND, Bounds, Case, Scene
from .clouds_moved import grazing
from .small_clouds import (
    CLOUDS,
    disc,
    fitted,
    frontal,
    scaled,
    scene_scaled,
    sphere,
)

__all__ = ["plane_cases"]

STEEPEST = 71.0
"""Degrees at which the wall of :func:`_leaning` has the steepest plane that a word holds: where it
fills the depth range, 252 levels a pixel."""

WALL = Bounds(depth_off=0.02)
"""Bounds of surfaces whose planes a word holds. At a silhouette, and where two discs cross, another
disc may be nearest by a level."""


def plane_cases() -> list[Case]:
    """Return cases of planes, each drawn by the preset ``plane``."""
    cases = [*_steep_cases(), *_range_cases(), *_eye_cases(), *_large_cases()]
    for name, cloud in CLOUDS.items():
        base = with_planes(partial(fitted, cloud()))
        # About the sphere's rim all planes are steeper than a word holds.
        most = 0.1 if name == "sphere" else 0.02
        same = Bounds(same_words=True, changed=0.0, depth_off=most)
        for power in (-100, 100):
            there = with_planes(partial(fitted, scaled(cloud(), 2.0**power)))
            cases.append(Case(f"{name}, file times 2^{power}", there, base, same))
            there = with_planes(partial(scene_scaled, fitted(cloud()), 2.0**power))
            cases.append(Case(f"{name}, scene times 2^{power}", there, base, same))
    return cases


def _steep_cases() -> list[Case]:
    """Return walls that lean more and more, about the border of the slope's range."""
    cases = []
    for degrees in (0.0, 30.0, 60.0, 68.0, 70.0, STEEPEST, 72.0, 75.0, 80.0, 85.0, 88.0):
        for way in (0.0, 45.0, 90.0, 200.0):
            there = with_planes(partial(_leaning, degrees, way))
            name = f"a wall leaning {degrees:g} degrees, turned {way:g}"
            # Far beyond the border depths are cut off, but pixels are as before.
            bounds = WALL if degrees <= 72.0 else Bounds()
            cases.append(Case(name, there, None, bounds))
    return cases


def _range_cases() -> list[Case]:
    """Return depth ranges for which slopes are far too large, or vanish."""
    cases = []
    for depth in (1e-300, 1e-100, 1e-12, 1e-6, 1e-3):
        there = with_planes(partial(_thin, depth))
        cases.append(Case(f"slanted discs in a depth range of {depth:g}", there))
    for away in (1e2, 1e6, 1e30, 1e100, 1e300):
        there = with_planes(partial(_far_point, away))
        # The reference squares distances.
        bounds = WALL if away < 1e50 else dataclasses.replace(SOUND, compared=False)
        cases.append(Case(f"a sphere, and a point {away:g} behind it", there, None, bounds))
    flat = with_planes(partial(frontal, disc()))
    cases.append(Case("a plane facing the eye (depth range 0)", flat, None, Bounds()))
    return cases


def _eye_cases() -> list[Case]:
    """Return planes that pass near the eye, or through it."""
    cases = [
        Case(
            f"all normals {grade:g} short of edge on",
            with_planes(partial(grazing, grade)),
            bounds=Bounds(refused=None if abs(grade) < 1e-2 else False, holes=None),
        )
        for grade in (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-12)
    ]
    for extent in (1e-9, 1.0):
        cases.append(
            Case(
                f"discs within {extent:g} of the eye, their planes through it",
                with_planes(partial(_through_the_eye, extent)),
                None,
                SOUND,
            )
        )
        there = with_planes(partial(about_the_eye, extent))
        cases.append(Case(f"the eye in a cloud of {extent:g}", there, None, SOUND))
    return cases


def _large_cases() -> list[Case]:
    """Return single large discs, most of which lies outside the image."""
    cases = []
    for degrees in (0.0, 30.0, 60.0, 80.0, 89.9):
        for pixels in (4.0, 10.0, 40.0, 200.0, 1000.0):
            there = with_planes(partial(one_disc, degrees, pixels))
            name = f"one disc of {pixels:g} pixels, slanted {degrees:g} degrees"
            cases.append(Case(name, there, None, Bounds(holes=None)))
    for pixels in (20.0, 60.0, 150.0):
        there = with_planes(partial(_at_the_border, pixels))
        name = f"discs of {pixels:g} pixels, of which a corner is in the image"
        cases.append(Case(name, there, None, Bounds(holes=None, depth_off=0.02)))
    return cases


def with_planes(make: Callable[[], Scene]) -> Callable[[], Scene]:
    """Return what makes the same scene for the preset ``plane``."""
    return partial(_for_planes, make)


def _for_planes(make: Callable[[], Scene]) -> Scene:
    return dataclasses.replace(make(), config=PLANE)


def _leaning(degrees: float, way: float) -> Scene:
    """Return a wall that leans by an angle, about an axis that is turned in the image."""
    wall = disc()
    lean, turn = math.radians(degrees), math.radians(way)
    about_x = np.array(
        [
            [1.0, 0.0, 0.0],
            [0.0, math.cos(lean), -math.sin(lean)],
            [0.0, math.sin(lean), math.cos(lean)],
        ]
    )
    about_z = np.array(
        [
            [math.cos(turn), -math.sin(turn), 0.0],
            [math.sin(turn), math.cos(turn), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    matrix = about_z @ about_x
    return frontal(Columns(wall.positions @ matrix.T, wall.normals @ matrix.T, wall.colours))


def _thin(depth: float) -> Scene:
    """Return discs that lean by 45 degrees, whose centres lie in a small range of depth."""
    wall = disc(100)
    rng = np.random.default_rng(11)
    around = rng.uniform(0.0, 2.0 * np.pi, len(wall.positions))
    normals = np.stack([np.cos(around), np.sin(around), np.ones_like(around)], axis=1)
    scene = frontal(Columns(wall.positions, normals / math.sqrt(2.0), wall.colours))
    # Relative to the eye, where a depth of 1e-300 is no rounding error.
    positions = scene.cloud.positions - scene.view.eye
    positions *= 1.0 / 4.0
    positions[:, 2] = -1.0 - depth * rng.uniform(0.0, 1.0, len(positions))
    cloud = dataclasses.replace(scene.cloud, positions=positions)
    view = dataclasses.replace(scene.view, eye=np.zeros(3))
    return dataclasses.replace(scene, cloud=cloud, view=view, radii=np.full(len(positions), 0.04))


def _far_point(away: float) -> Scene:
    """Return a sphere, and behind it a point so far away that its planes have no slope left."""
    scene = frontal(sphere())
    position = np.array([[0.0, 0.0, -away]])
    return dataclasses.replace(
        scene,
        cloud=_more(scene.cloud, position, np.array([[0.0, 0.0, 1.0]])),
        radii=np.append(scene.radii, 0.01 * away),
    )


def _through_the_eye(extent: float) -> Scene:
    """Return points all around the eye, with planes that pass through it but for rounding."""
    scene = about_the_eye(extent)
    rng = np.random.default_rng(12)
    across = np.cross(scene.cloud.positions, rng.normal(size=(len(scene.cloud), 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    cloud = dataclasses.replace(scene.cloud, normals=across.astype(np.float32))
    return dataclasses.replace(scene, cloud=cloud)


def _at_the_border(pixels: float) -> Scene:
    """Return slanted discs about the image, whose centres lie outside it by nearly their radius."""
    scene = frontal(Columns(np.zeros((1, 3))))
    rng = np.random.default_rng(13)
    count = 60
    view = scene.view
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    border = 0.5 * np.array([view.width, view.height]) + 0.42 * pixels
    place = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    place *= (border / np.maximum(np.abs(place), 1e-9)).min(axis=1, keepdims=True)
    depth = rng.uniform(3.0, 5.0, count)
    positions = np.stack([*(place.T * depth / view.focal), -depth], axis=1)
    leaning = rng.normal(size=(count, 3)) * [0.6, 0.6, 0.0] + [0.0, 0.0, 1.0]
    leaning /= np.linalg.norm(leaning, axis=1, keepdims=True)
    cloud = _more(_none(scene.cloud), positions + view.eye, leaning)
    return dataclasses.replace(scene, cloud=cloud, radii=0.5 * pixels * depth / view.focal)


def _none(cloud: Cloud) -> Cloud:
    """Return a cloud without its points."""
    parts = ("positions", "normals", "colours", "two_sided")
    return dataclasses.replace(cloud, **{name: getattr(cloud, name)[:0] for name in parts})


def _more(cloud: Cloud, positions: npt.NDArray[np.float64], normals: npt.NDArray[Any]) -> Cloud:
    """Return a cloud with further points."""
    count = len(positions)
    return dataclasses.replace(
        cloud,
        positions=np.concatenate([cloud.positions, positions]),
        normals=np.concatenate([cloud.normals, normals]).astype(np.float32),
        colours=np.concatenate([cloud.colours, np.full((count, 3), 200, np.uint8)]),
        two_sided=np.concatenate([cloud.two_sided, np.zeros(count, np.bool_)]),
    )
