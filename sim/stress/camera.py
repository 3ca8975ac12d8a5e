"""Stress cases of the camera: points near the eye, fields of view, sizes of splats."""

from __future__ import annotations

import dataclasses
import math
from functools import partial

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud
from splatline.host.files.assemble import Columns
from splatline.host.visibility.view import View

from .case import SOUND, Bounds, Case, Scene
from .small_clouds import CLOUDS, SIZE, disc, fitted, frontal, sphere

__all__ = ["about_the_eye", "camera_cases", "fov_cases", "one_disc", "size_cases"]

TOWARDS = (0.0, 0.0, 1.0)
"""Direction to the eye of a frontal scene."""

ISOLATED = Bounds(holes=None, stray=1e-3)
"""Bounds of isolated discs in ``paper`` and ``fast``. Rounding of position and diameter moves a
disc's edge by up to a pixel, and no neighbour covers the difference. Quantised normals move the tip
of a long ellipse a little further."""


def camera_cases() -> list[Case]:
    """Return cases of points at the eye, behind it and very close in front of it."""
    plain = frontal(sphere(), near=1e-3)
    same = Bounds(same_elements=True)
    base = partial(_given, plain)
    cases = []
    for name, away, aside in (
        ("at the eye", 0.0, 0.0),
        ("beside the eye", 0.0, 0.5),
        ("behind the eye", -1.0, 0.0),
        ("1e-300 behind the eye", -1e-300, 0.0),
        ("at near (1 - 1e-12)", 1e-3 * (1.0 - 1e-12), 0.0),
        ("at near (1 + 1e-12), 20 degrees beside the image", 1e-3 * (1.0 + 1e-12), 1e-3),
    ):
        radius = 1e-5 if aside == 1e-3 else 0.05
        there = partial(_with_point, plain, away, aside, radius)
        cases.append(Case(f"a point {name}", there, base, same))
    for away in (1e-3 * (1.0 + 1e-12), 1e-6, 1e-12, 1e-30, 1e-60, 1e-150, 1e-300):
        for aside, radius in ((0.0, 0.05), (1e-3, 0.05), (0.0, 1e-12)):
            name = f"a point {away:g} in front of the eye, {aside:g} aside, radius {radius:g}"
            scene = _near(plain, min(0.5 * away, 1e-3) if away < 1e-3 else 1e-3)
            # The point's disc faces the eye, so it is a circle at any distance.
            bounds = Bounds(stray=None)
            # The reference squares distances, and the square of 1e-300 is 0 in float64.
            bounds = dataclasses.replace(bounds, compared=away > 1e-160)
            there = partial(_with_point, scene, away, aside, radius)
            cases.append(Case(name, there, bounds=bounds))
    cases.append(
        Case("all points within 1e-9 of the eye", partial(about_the_eye, 1e-9), None, SOUND)
    )
    cases.append(Case("the eye inside the cloud", partial(about_the_eye, 1.0), None, SOUND))
    for size in ((1, 1), (1, 81), (97, 1), (2, 3), (512, 5), (5, 1024)):
        # Of so few pixels, a single one that a disc's edge misses is a large share.
        there = partial(fitted, sphere(500), size=size)
        name = f"image of {size[0]} x {size[1]} pixels"
        cases.append(Case(name, there, None, Bounds(holes=0.1)))
    return cases


def fov_cases() -> list[Case]:
    """Return cases of fields of view from 0.1 to 170 degrees, seen from outside and inside."""
    cases = []
    for fov in (0.1, 1.0, 10.0, 35.0, 60.0, 90.0, 120.0, 150.0, 170.0):
        # A wide view fitted to the cloud puts the eye so near that a disc's far side is much
        # further away than its near side. The shape table has no entry for such perspective.
        rough = SOUND if fov >= 120.0 else None
        for name, cloud in CLOUDS.items():
            there = partial(fitted, cloud(), fov=fov)
            cases.append(Case(f"{name}, {fov:g} degrees", there, rough=rough))
        cases.append(Case(f"a room, {fov:g} degrees", partial(_room, fov), rough=rough))
    for zoom in (1e-9, 1e-3, 0.1, 10.0, 1e3):
        bounds = Bounds(refused=None if zoom < 1e-2 else False)
        cases.append(
            Case(f"sphere, zoom {zoom:g}", partial(fitted, sphere(), zoom=zoom), None, bounds)
        )
    return cases


def size_cases() -> list[Case]:
    """Return cases of splats from a millionth of a pixel to thousands of pixels."""
    cases = []
    for pixels in (1e-6, 1e-3, 0.1, 1.0, 3.0, 8.0, 9.0, 16.0, 17.0, 64.0, 500.0, 5000.0):
        wall = partial(_sized, disc(40 if pixels > 20 else 400), pixels)
        name = f"facing discs of {pixels:g} pixels"
        cases.append(Case(name, wall, None, *_isolated(pixels)))
    for pixels in (1e-6, 0.1, 1.0, 4.0, 12.0, 32.0):
        ball = partial(_sized, sphere(60 if pixels > 20 else 600), pixels)
        name = f"a sphere of discs of {pixels:g} pixels"
        cases.append(Case(name, ball, None, *_isolated(pixels)))
    for pixels in (200.0, 5000.0):
        ball = partial(_sized, sphere(60), pixels)
        cases.append(Case(f"a sphere of discs of {pixels:g} pixels", ball, bounds=SOUND))
    for degrees in (0.0, 30.0, 60.0, 80.0, 89.9):
        for pixels in (10.0, 40.0, 200.0, 1000.0):
            name = f"one disc of {pixels:g} pixels, slanted {degrees:g} degrees"
            rough = SOUND if degrees and pixels > 10.0 else ISOLATED
            cases.append(Case(name, partial(one_disc, degrees, pixels), rough=rough))
    uneven = partial(_uneven, disc(400))
    cases.append(Case("facing discs from 1e-6 to 5000 pixels in one cloud", uneven))
    return cases


def _isolated(pixels: float) -> tuple[Bounds, Bounds]:
    """Return the bounds of isolated discs in ``exact``, and in the other qualities."""
    refused = None if pixels < 0.5 else False
    return Bounds(refused=refused), dataclasses.replace(ISOLATED, refused=refused)


def _given(scene: Scene) -> Scene:
    return scene


def _near(scene: Scene, near: float) -> Scene:
    """Return a scene with another near plane."""
    return dataclasses.replace(scene, view=dataclasses.replace(scene.view, near=near))


def _with_point(scene: Scene, away: float, aside: float, radius: float) -> Scene:
    """Return a scene with one more point at a distance along the view, facing the eye."""
    # The eye moves to 0; relative to 4, a distance of 1e-300 would be rounded to 0.
    cloud, view = scene.cloud, scene.view
    position = np.array([[aside, 0.0, -away]])
    return dataclasses.replace(
        scene,
        cloud=_cloud(
            np.concatenate([cloud.positions - view.eye, position]),
            np.concatenate([cloud.normals, [TOWARDS]]),
            np.concatenate([cloud.colours, [[255, 255, 0]]]),
        ),
        view=dataclasses.replace(view, eye=np.zeros(3)),
        radii=np.append(scene.radii, radius),
    )


def about_the_eye(extent: float) -> Scene:
    """Return a scene of points all around the eye, each facing it."""
    ball = sphere(800)
    positions = ball.positions * np.random.default_rng(8).uniform(0.0, extent, (800, 1))
    cloud = _cloud(positions, -ball.positions, np.asarray(ball.colours))
    axes = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    view = View(np.zeros(3), axes, 100.0, *SIZE, 1e-6 * extent)
    return Scene(cloud, view, np.full(800, 0.05 * extent))


def _room(fov: float) -> Scene:
    """Return a sphere seen from its centre; its points are spread over the field of view."""
    axes = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    half = math.radians(fov) / 2.0
    reach = math.atan(1.5 * math.tan(half))  # the image's corners are further out than its sides
    rng = np.random.default_rng(9)
    count = 4000
    # Even by solid angle means 1 - cos is uniform. The half angle avoids cancellation in 1 - cos.
    most = math.sin(0.5 * min(1.2 * reach, math.pi))
    angle = 2.0 * np.arcsin(most * np.sqrt(rng.uniform(0.0, 1.0, count)))
    around = rng.uniform(0.0, 2.0 * np.pi, count)
    across = np.stack([np.cos(around), np.sin(around)], axis=1) * np.sin(angle)[:, np.newaxis]
    positions = np.concatenate([across, -np.cos(angle)[:, np.newaxis]], axis=1)
    spacing = 2.0 * most * math.sqrt(math.pi / count)  # side of each point's share of the sphere
    colours = np.array([[250, 40, 30], [30, 200, 60], [40, 60, 240]], np.uint8)
    cloud = _cloud(positions, -positions, colours[np.floor(6.0 * around / np.pi).astype(int) % 3])
    view = View(np.zeros(3), axes, 0.5 * min(SIZE) / math.tan(half), *SIZE, 1e-3)
    return Scene(cloud, view, np.full(count, 1.5 * spacing))


def _sized(columns: Columns, pixels: float) -> Scene:
    """Return a frontal scene in which every disc has the same diameter in pixels."""
    scene = frontal(columns)
    distance = (scene.cloud.positions - scene.view.eye) @ scene.view.axes[2]
    return dataclasses.replace(scene, radii=0.5 * pixels * distance / scene.view.focal)


def _uneven(columns: Columns) -> Scene:
    """Return a frontal scene with diameters from 1e-6 to 5000 pixels."""
    scene = _sized(columns, 1.0)
    pixels = 10.0 ** np.linspace(-6.0, math.log10(5000.0), len(scene.radii))
    return dataclasses.replace(scene, radii=scene.radii * pixels)


def one_disc(degrees: float, pixels: float) -> Scene:
    """Return a single disc, off the image's middle, inclined to its ray by an angle."""
    angle = math.radians(degrees)
    scene = frontal(Columns(np.zeros((1, 3))))
    position = np.array([[0.3, -0.2, 0.0]])
    ray = scene.view.eye - position[0]
    ray /= np.linalg.norm(ray)
    across = np.cross(ray, [0.8, -0.6, 0.0])
    across /= np.linalg.norm(across)
    normal = math.cos(angle) * ray + math.sin(angle) * across
    cloud = _cloud(position, normal[np.newaxis], [[250, 120, 30]])
    return dataclasses.replace(
        scene, cloud=cloud, radii=np.array([0.5 * pixels * 4.0 / scene.view.focal])
    )


def _cloud(
    positions: npt.NDArray[np.float64], normals: npt.ArrayLike, colours: npt.ArrayLike
) -> Cloud:
    """Return a cloud with exactly these coordinates, which is not moved to its own centre."""
    return Cloud(
        positions=positions,
        normals=np.ascontiguousarray(normals, np.float32),
        colours=np.ascontiguousarray(colours, np.uint8),
        two_sided=np.zeros(len(positions), np.bool_),
        origin=np.zeros(3),
        name="stress",
        dropped={},
    )
