import dataclasses

import numpy as np
import pytest

from splatline.host.cloud.normals import estimate_normals
from splatline.host.cloud.upward import turn_upward, upward_of
from tests.support.clouds import cloud_of, sphere


def unsigned(positions):
    """Return a survey with estimated normals."""
    normals = estimate_normals(np.asarray(positions, np.float64))
    return dataclasses.replace(cloud_of(positions, normals, two_sided=True), up="z")


def hills(count=40_000, seed=1):
    """Return points of a height field, and its true normals."""
    x, y = np.random.default_rng(seed).uniform(-1, 1, (2, count))
    positions = np.stack([x, y, 0.2 * np.sin(5 * x) * np.cos(4 * y)], axis=1)
    slope_x, slope_y = np.cos(5 * x) * np.cos(4 * y), -0.8 * np.sin(5 * x) * np.sin(4 * y)
    return positions, np.stack([-slope_x, -slope_y, np.ones(count)], axis=1)


def test_normals_of_a_height_field_point_up():
    positions, truth = hills()
    turned = turn_upward(unsigned(positions), "z")
    assert turned.two_sided.mean() < 0.001
    signed = ~turned.two_sided
    assert (np.einsum("ij,ij->i", turned.normals, truth)[signed] > 0).all()


@pytest.mark.parametrize("up", ["x", "y", "z", "-x", "-y", "-z"])
def test_any_axis_points_up(up):
    axis, sign = "xyz".index(up[-1]), -1 if up.startswith("-") else 1
    positions, _ = hills()
    order = np.roll([0, 1, 2], axis + 1)
    turned = turn_upward(unsigned(positions[:, order]), up)
    assert turned.two_sided.mean() < 0.001
    assert (sign * turned.normals[~turned.two_sided, axis] > 0).all()


def test_only_the_sign_of_estimated_normals_changes():
    positions, _ = hills(2000)
    cloud = unsigned(positions)
    given = np.arange(2000) % 2 == 0
    cloud = dataclasses.replace(cloud, two_sided=~given)
    turned = turn_upward(cloud, "z")
    assert np.array_equal(np.abs(turned.normals), np.abs(cloud.normals))
    assert np.array_equal(turned.normals[given], cloud.normals[given])
    assert not turned.two_sided[given].any()


def test_only_a_survey_that_is_seen_from_above_is_turned():
    cloud = unsigned(hills(2000)[0])
    assert turn_upward(cloud, upward_of((30.0, 0.0), "z")) is not cloud
    assert turn_upward(cloud, upward_of((30.0, -1.0), "z")) is cloud
    assert turn_upward(cloud, upward_of((30.0, 181.0), "z")) is cloud
    other = dataclasses.replace(cloud, up="y")
    assert turn_upward(other, "z") is other


def test_a_cloud_with_normals_is_left_alone():
    cloud = dataclasses.replace(sphere(500), up="z")
    assert turn_upward(cloud, "z") is cloud


def test_what_has_two_layers_or_none_keeps_both_sides():
    rng = np.random.default_rng(3)
    floor = np.append(rng.uniform(0, 10, (20_000, 2)), rng.normal(scale=0.01, size=(20_000, 1)), 1)
    tree = rng.uniform(0, 10, (20_000, 3))
    wall = np.stack([rng.uniform(0, 10, 20_000), np.zeros(20_000), rng.uniform(0, 3, 20_000)], 1)
    for points in (
        np.concatenate([floor, floor + np.array([0, 0, 3])]),
        tree,
        wall,
        sphere(20_000).positions,
    ):
        assert turn_upward(unsigned(points), "z").two_sided.mean() > 0.97


def test_a_wall_beside_the_ground_keeps_both_sides():
    rng = np.random.default_rng(4)
    ground = np.append(rng.uniform(0, 10, (40_000, 2)), np.zeros((40_000, 1)), 1)
    wall = np.stack([rng.uniform(0, 10, 9000), np.full(9000, 5.0), rng.uniform(1, 4, 9000)], 1)
    turned = turn_upward(unsigned(np.concatenate([ground, wall])), "z")
    assert turned.two_sided[40_000:].all()
    assert turned.two_sided[:40_000].mean() < 0.05


@pytest.mark.parametrize(
    "positions",
    [
        [[0, 0, 0]],
        [[0, 0, 0]] * 5,
        [[0, 0, i] for i in range(9)],
        [[i, 0, 0] for i in range(9)],
        [[0, 0, 0], [1e99, -1e99, 1e99]],
        [[0, 0, 0], [1e-310, 0, 0], [0, 1e-310, 0]],
        [[0, 0, 0], [1e-200, 0, 0], [0, 1e-200, 0]],
        [[0.1 * i, 0.3 * i, 0] for i in range(1000)],
    ],
)
def test_any_positions_are_taken(positions):
    cloud = unsigned(positions)
    turned = turn_upward(cloud, "z")
    assert len(turned) == len(cloud)
    assert np.array_equal(np.abs(turned.normals), np.abs(cloud.normals))


def test_the_order_along_the_curve_is_kept():
    cloud = unsigned(hills(500)[0])
    curve, cells = cloud.curve, cloud.cells
    turned = turn_upward(cloud, "z")
    assert turned.curve is curve
    assert turned.cells is cells
