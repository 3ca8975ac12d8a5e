import numpy as np
import pytest

from splatline.host.shading.normal_levels import level_slopes
from splatline.host.visibility.block_index import build_index
from splatline.host.visibility.project import project
from splatline.host.visibility.skips import DEFAULT_SKIPS
from splatline.host.visibility.view import View
from tests.support.clouds import cloud_of


def view(width=200, height=100, focal=150.0):
    return View(np.zeros(3), np.eye(3), focal, width, height, near=0.1)


def seen(cloud, radii, at=None, skips=DEFAULT_SKIPS - {"no_pixel"}):
    """Splats, each with its level of the normal for a look."""
    index = build_index(cloud, radii)
    levels = np.stack([np.arange(4096), np.zeros(4096)]).astype(np.uint32).reshape(2, 64, 64)
    return project(index, at or view(), levels, 14, skips)


def test_a_point_lands_where_the_pinhole_says():
    splat = seen(cloud_of([0.2, -0.1, 2.0], [0, 0, -1]), np.array([0.05])).together()[0]
    assert splat["column"] == pytest.approx(100 + 150 * 0.1)
    assert splat["line"] == pytest.approx(50 - 150 * 0.05)
    assert splat["depth"] == 2.0
    assert splat["diameter"] == pytest.approx(2 * 0.05 * 150 / 2)


def test_each_point_is_kept_or_counted_under_one_reason():
    positions = [[0, 0, 2], [0, 0, 2], [0, 0, -2], [0, 0, 0.05], [9, 0, 2], [0, 9, 2], [0, -9, 2]]
    normals = [[0, 0, -1], [0, 0, 1], *[[0, 0, -1]] * 5]
    splats = seen(cloud_of(positions, normals), np.full(7, 0.01))
    assert len(splats) == 1
    assert {name: count for name, count in splats.culled.items() if count} == {
        "outside": 5,
        "facing_away": 1,
    }


def test_facing_is_judged_along_the_ray_to_the_point():
    # Far to the right the eye sees what points a little away from it along the axis.
    position = [1.3, 0, 2.0]
    normal = np.array([-2.0, 0, 1.0]) / np.sqrt(5)
    splats = seen(cloud_of(position, normal), np.array([0.1]))
    assert len(splats) == 1
    assert len(seen(cloud_of([0, 0, 2.0], normal), np.array([0.1]))) == 0


def test_an_estimated_normal_is_turned_to_the_eye():
    away = cloud_of([[0.1, 0.1, 2.0]] * 2, [[0.3, 0, 0.9], [-0.3, 0, -0.9]], two_sided=True)
    first, second = seen(away, np.full(2, 0.1)).together()
    assert first == second


def test_slopes_are_those_of_the_disc_s_depth_and_shades_are_by_the_normal():
    rng = np.random.default_rng(2)
    slopes = level_slopes()
    for _ in range(200):
        position = np.array([*rng.uniform(-0.5, 0.5, 2), 2.0])
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        splat = seen(cloud_of(position, normal, two_sided=True), np.array([0.1])).together()
        if not len(splat):
            continue
        # dz/ds along the image's x, by intersecting a neighbouring ray with the disc's plane.
        for axis, slope in enumerate((splat["slope_x"][0], splat["slope_y"][0])):
            ray = position / position[2]
            shift = 1e-6
            ray[axis] += shift
            z = (normal @ position) / (normal @ ray)
            true = -(z - 2.0) / (shift * 2.0)
            assert np.arctan(slope) == pytest.approx(np.arctan(true), abs=1e-3)
        if normal @ position > 0:
            normal = -normal
        if normal[2] < -1e-3:
            # Half a level of n' / (1 + |n'|) from the normal's own.
            for part, level in zip(normal[:2], divmod(int(splat["look"][0]), 64), strict=True):
                ours, theirs = part / normal[2], slopes[level]
                assert abs(ours / (1 + abs(ours)) - theirs / (1 + abs(theirs))) <= 1 / 64 + 1e-6


def test_a_point_in_or_behind_the_eye_is_outside_and_never_divides_by_zero():
    positions = [[0, 0, 0], [1, 0, 0], [0, 0, -1e-300]]
    splats = seen(cloud_of(positions, [[0, 0, -1]] * 3), np.full(3, 1.0))
    assert len(splats) == 0
    assert splats.culled["outside"] == 3
