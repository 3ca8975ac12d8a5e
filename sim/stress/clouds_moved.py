"""Stress cases of clouds: moved, scaled, degenerate, of other data types, with hard normals."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from splatline.host.files.assemble import Columns

from .case import SOUND, Bounds, Case, Scene
from .small_clouds import (
    CLOUDS,
    disc,
    fitted,
    frontal,
    on_grid,
    scaled,
    scene_scaled,
    shifted,
    sphere,
    terrain,
)

__all__ = ["degenerate_cases", "dtype_cases", "grazing", "normal_cases", "transform_cases"]

ROUNDING = Bounds(changed=1e-3, loss=0.35)
"""Bounds of an input that differs from its base by rounding alone. A coordinate error of 1e-8 of
the cloud's size moves a splat by about 1e-6 pixels. With some 10^5 borders and depth steps in a
picture, 0.1 pixels change in the mean. The bound of 0.1 % of the pixels allows for a few ties. If
each of these pixels had the largest possible error, the mean square error would grow by 0.001,
which is 0.35 dB at 19 dB."""

SAME = Bounds(same_words=True, changed=0.0, loss=0.0)


def transform_cases() -> list[Case]:
    """Return cases of clouds in other units and far from zero."""
    cases = []
    for name, cloud in CLOUDS.items():
        base = partial(fitted, cloud())
        for power in (-100, -30, -1, 1, 30, 100):
            there = partial(fitted, scaled(cloud(), 2.0**power))
            cases.append(Case(f"{name}, file times 2^{power}", there, base, SAME))
        for power in (-30, 30):
            there = partial(scene_scaled, base(), 2.0**power)
            cases.append(Case(f"{name}, scene times 2^{power}", there, base, SAME))
        for factor in (1e-9, 1e-5, 0.3, 1e3, 1e9):
            there = partial(fitted, scaled(cloud(), factor))
            cases.append(Case(f"{name}, file times {factor:g}", there, base, ROUNDING))
        for shift in (1e3, 1e6, 1e8):
            there = partial(fitted, shifted(cloud(), (shift, -shift, 0.3 * shift)))
            cases.append(Case(f"{name}, file moved by {shift:g}", there, base, ROUNDING))
        exact = on_grid(cloud())
        there = partial(fitted, shifted(exact, (1e8, -1e8, 3e7)))
        same = partial(fitted, exact)
        cases.append(Case(f"{name} on a grid of 2^-10, moved by 1e8", there, same, SAME))
        large = shifted(scaled(cloud(), 1e9), (1e8, 1e8, -1e8))
        cases.append(
            Case(f"{name}, times 1e9, moved by 1e8", partial(fitted, large), base, ROUNDING)
        )
    return cases


def degenerate_cases() -> list[Case]:
    """Return cases of clouds without extent in one dimension or more."""
    rng = np.random.default_rng(5)
    along = rng.uniform(-1.0, 1.0, (400, 1))
    depth = Bounds()
    alone = np.zeros((1, 3))
    wall = disc()
    leaning = wall.positions @ np.array([[1.0, 0, 0], [0, math.sqrt(0.5), math.sqrt(0.5)], [0] * 3])
    hair = wall.positions + [0, 0, 1e-12] * rng.uniform(-1.0, 1.0, (len(wall.positions), 1))
    grid = np.stack(np.meshgrid(*[np.arange(10.0)] * 3), axis=-1).reshape(-1, 3)
    edge_on = Columns(wall.positions, np.tile([0.0, 1.0, 0.0], (len(wall.positions), 1)))
    level = Columns(wall.positions[:, [0, 2, 1]] * [1.0, 0.0, 1.0], edge_on.normals)
    cases: list[tuple[str, Callable[[Columns], Scene], Columns, Bounds]] = [
        ("a plane facing the eye (depth range 0)", frontal, wall, depth),
        (
            "the same, depths within 1e-12",
            frontal,
            dataclasses.replace(wall, positions=hair),
            depth,
        ),
        ("a plane facing the eye, no normals", frontal, Columns(wall.positions), depth),
        ("a leaning plane, no normals", frontal, Columns(leaning), depth),
        ("a plane seen edge on", frontal, level, Bounds(refused=True)),
        ("a plane seen edge on, no normals", frontal, Columns(level.positions), depth),
        ("a line across", frontal, Columns(along * [1.0, 0.0, 0.0]), depth),
        ("a line askew", frontal, Columns(along * [0.7, 0.5, -0.6]), depth),
        ("a line through the eye", frontal, Columns(along * [0.0, 0.0, 1.0]), depth),
        ("a line fitted to the image", fitted, Columns(along * [1.0, 2.0, -0.5]), depth),
        ("one point", fitted, Columns(alone), depth),
        ("one point at 1e8", fitted, Columns(alone + 1e8), depth),
        ("a thousand points at one place", fitted, Columns(np.tile(alone, (1000, 1))), depth),
        ("two points", fitted, Columns(np.array([[0.0, 0, 0], [1.0, 2.0, 3.0]])), depth),
        (
            "two points 1e-100 apart",
            fitted,
            Columns(np.array([[0.0, 0, 0], [1e-100, 0, 0]])),
            depth,
        ),
        ("two points 1e100 apart", fitted, Columns(np.array([[0.0] * 3, [1e100, 0, 0]])), depth),
        ("three points", fitted, Columns(np.eye(3)), depth),
        ("a lattice, its planes facing the eye", frontal, Columns(grid / 9.0 - 0.5), depth),
    ]
    made = [Case(name, partial(make, cloud), bounds=bounds) for name, make, cloud, bounds in cases]
    # Discs of two or three points are a large part of the image, too wide for the first order.
    few = "two points", "three points"
    return [
        dataclasses.replace(case, rough=SOUND) if case.name.startswith(few) else case
        for case in made
    ]


def normal_cases() -> list[Case]:
    """Return cases of normals that are not of unit length, missing, or almost edge on."""
    ball = sphere()
    base = partial(fitted, ball)
    normals = np.asarray(ball.normals)
    cases = []
    for power in (-1000, -100, -1, 1, 100, 1000):
        there = partial(fitted, dataclasses.replace(ball, normals=normals * 2.0**power))
        cases.append(Case(f"normals times 2^{power}", there, base, SAME))
    for factor in (1e-310, 1e-30, 1e-3, 1e3, 1e30):
        there = partial(fitted, dataclasses.replace(ball, normals=normals * factor))
        cases.append(Case(f"normals times {factor:g}", there, base, ROUNDING))
    mixed = normals * 10.0 ** np.random.default_rng(6).uniform(-30, 30, (len(normals), 1))
    there = partial(fitted, dataclasses.replace(ball, normals=mixed))
    cases.append(Case("each normal of another length, 1e-30..1e30", there, base, ROUNDING))
    # Estimated normals are off by a few degrees and have no sign, so the picture differs while its
    # error is about the same. Points at the back are drawn as well, which changes the depth range.
    near = Bounds(loss=0.5)
    for name, value in (("0", 0.0), ("NaN", np.nan), ("inf", np.inf)):
        broken = normals.copy()
        broken[::10] = value
        there = partial(fitted, dataclasses.replace(ball, normals=broken))
        cases.append(Case(f"every tenth normal {name}", there, base, near))
        everywhere = np.full_like(normals, value)
        there = partial(fitted, dataclasses.replace(ball, normals=everywhere))
        cases.append(Case(f"every normal {name}", there, base, Bounds(loss=1.0)))
    broken = normals.copy()
    broken[::10, 1] = np.nan
    there = partial(fitted, dataclasses.replace(ball, normals=broken))
    cases.append(Case("one component NaN in every tenth", there, base, near))
    cases += [
        # Quantised normals end at 88.6 degrees; beyond, the direction of a long ellipse is lost.
        Case(
            f"all normals {grade:g} short of edge on",
            partial(grazing, grade),
            bounds=Bounds(refused=None if grade < 1e-2 else False),
            rough=SOUND,
        )
        for grade in (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)
    ]
    cases += [
        Case(f"all normals {grade:g} past edge on", partial(grazing, -grade), None, away)
        for grade, away in ((1e-2, Bounds(refused=True)), (1e-6, Bounds(refused=True)))
    ]
    return cases


def dtype_cases() -> list[Case]:
    """Return cases of files of every data type; equal values give equal pictures."""
    ball = on_grid(sphere(), 2.0**-6)  # 64ths from -1 to 1, exact in every type below
    base = partial(fitted, ball)
    cases = []
    for dtype in ("f2", "f4", ">f4", "f8", ">f8", "longdouble"):
        columns = dataclasses.replace(ball, positions=ball.positions.astype(dtype))
        cases.append(Case(f"positions {np.dtype(dtype)}", partial(fitted, columns), base, SAME))
    whole = np.rint(ball.positions * 64)
    for dtype, factor, offset in (
        ("i1", 1, 0),
        ("u1", 1, 64),
        ("i2", 2**8, 0),
        ("u2", 2**8, 2**15),
        ("i4", 2**24, 0),
        ("u4", 2**20, 2**31),
        ("i8", 2**50, 0),
        ("u8", 2**40, 2**63),
    ):
        # Differences of unsigned integers would wrap, so the reader must convert them first.
        values = whole.astype("i8") * factor
        positions = (values.astype("u8") + np.uint64(offset)) if offset else values
        columns = dataclasses.replace(ball, positions=positions.astype(dtype))
        case = Case(f"positions {np.dtype(dtype)}", partial(fitted, columns), base, SAME)
        cases.append(case)
    colours = np.asarray(ball.colours)
    for name, values in (
        ("uint16, times 257", colours.astype(np.uint16) * np.uint16(257)),
        ("float32 in 0..1", (colours / 255.0).astype(np.float32)),
        ("int64 in 0..255", colours.astype(np.int64)),
    ):
        columns = dataclasses.replace(ball, colours=values)
        cases.append(Case(f"colours {name}", partial(fitted, columns), base, SAME))
    normals = np.asarray(ball.normals).astype(np.float32)
    columns = dataclasses.replace(ball, normals=normals)
    cases.append(Case("normals float32", partial(fitted, columns), base, ROUNDING))
    return cases + _lost_cases(ball)


def _lost_cases(ball: Columns) -> list[Case]:
    """Return cases of files whose data type rounds the cloud; the rounded cloud is drawn."""
    cases = []
    hills = terrain()
    for shift in (1e3, 1e5, 1e8):
        moved = shifted(hills, (shift, shift, shift))
        single = dataclasses.replace(moved, positions=moved.positions.astype(np.float32))
        held = dataclasses.replace(moved, positions=single.positions.astype(np.float64))
        cases.append(
            Case(
                f"float32 at {shift:g}, against float64 of the same values",
                partial(fitted, single),
                partial(fitted, held),
                # At 1e8 the step of float32 is 8: all points coincide, and one disc is drawn.
                dataclasses.replace(SAME),
            )
        )
    moved = shifted(ball, (1e3, 1e3, 1e3))
    single = dataclasses.replace(moved, positions=(moved.positions + 1e-3).astype(np.float32))
    cases.append(
        Case(
            "float32 at 1000, against float64 at 0",
            partial(fitted, single),
            partial(fitted, ball),
            # The step is 6e-5, or 0.003 pixels: one border in three hundred is crossed.
            Bounds(changed=0.03, loss=0.5),
        )
    )
    return cases


def _given(scene: Scene) -> Scene:
    return scene


def grazing(grade: float) -> Scene:
    """Return a sphere whose normals all have the cosine ``grade`` towards the eye."""
    scene = frontal(sphere(800))
    ray = scene.cloud.positions - scene.view.eye
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    across = np.cross(ray, np.random.default_rng(7).normal(size=ray.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    normals: Any = (math.sqrt(1.0 - grade * grade) * across - grade * ray).astype(np.float32)
    return dataclasses.replace(scene, cloud=dataclasses.replace(scene.cloud, normals=normals))
