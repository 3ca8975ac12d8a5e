import numpy as np
import pytest
from clouds import cloud_of

from splatline.host.project import project
from splatline.host.shapes import level_slopes
from splatline.host.view import View


def view(width=200, height=100, focal=150.0):
    return View(np.zeros(3), np.eye(3), focal, width, height, near=0.1)


def test_a_point_lands_where_the_pinhole_says():
    splats = project(cloud_of([0.2, -0.1, 2.0], [0, 0, -1]), view(), np.array([0.05]))
    assert splats.column[0] == pytest.approx(100 + 150 * 0.1)
    assert splats.line[0] == pytest.approx(50 - 150 * 0.05)
    assert splats.depth[0] == 2.0
    assert splats.diameter[0] == pytest.approx(2 * 0.05 * 150 / 2)


def test_each_point_is_kept_or_counted_under_one_reason():
    positions = [[0, 0, 2], [0, 0, 2], [0, 0, -2], [0, 0, 0.05], [9, 0, 2], [0, 9, 2], [0, -9, 2]]
    normals = [[0, 0, -1], [0, 0, 1], *[[0, 0, -1]] * 5]
    splats = project(cloud_of(positions, normals), view(), np.full(7, 0.01))
    assert splats.point.tolist() == [0]
    assert splats.culled == {"outside": 5, "facing_away": 1}


def test_facing_is_judged_along_the_ray_to_the_point():
    # Far to the right the eye sees what points a little away from it along the axis.
    position = [1.3, 0, 2.0]
    normal = np.array([-2.0, 0, 1.0]) / np.sqrt(5)
    splats = project(cloud_of(position, normal), view(), np.array([0.1]))
    assert len(splats) == 1
    assert len(project(cloud_of([0, 0, 2.0], normal), view(), np.array([0.1]))) == 0


def test_an_estimated_normal_is_turned_to_the_eye():
    away = cloud_of([[0.1, 0.1, 2.0]] * 2, [[0.3, 0, 0.9], [-0.3, 0, -0.9]], two_sided=True)
    splats = project(away, view(), np.full(2, 0.1))
    assert len(splats) == 2
    assert splats.shape[0] == splats.shape[1]
    assert splats.shade[0] == splats.shade[1]


def test_the_shape_s_levels_are_the_slopes_of_the_disc_s_depth():
    rng = np.random.default_rng(2)
    slopes = level_slopes()
    step = np.pi / 64
    for _ in range(200):
        position = np.array([*rng.uniform(-0.5, 0.5, 2), 2.0])
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        splats = project(cloud_of(position, normal, two_sided=True), view(), np.array([0.1]))
        if not len(splats):
            continue
        # dz/ds along the image's x, by intersecting a neighbouring ray with the disc's plane.
        for axis, level in ((0, splats.shape[0] // 64), (1, splats.shape[0] % 64)):
            ray = position / position[2]
            shift = 1e-6
            ray[axis] += shift
            z = (normal @ position) / (normal @ ray)
            slope = (z - 2.0) / (shift * 2.0)
            assert abs(np.arctan(-slope) - np.arctan(slopes[level])) <= step / 2 + 1e-3


def test_a_point_in_or_behind_the_eye_is_outside_and_never_divides_by_zero():
    positions = [[0, 0, 0], [1, 0, 0], [0, 0, -1e-300]]
    splats = project(cloud_of(positions, [[0, 0, -1]] * 3), view(), np.full(3, 1.0))
    assert len(splats) == 0
    assert splats.culled["outside"] == 3
