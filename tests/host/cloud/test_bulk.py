"""Points far from the rest of a cloud."""

import numpy as np
import pytest

from splatline.host.cloud.bulk import far_points, select
from splatline.host.files.assemble import Columns, assemble_cloud
from tests.support.clouds import sphere


def ball(count, seed=1):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


@pytest.mark.parametrize("count", [8, 100, 5000, 250_000])
@pytest.mark.parametrize("where", [[1e6, 0, 0], [0, -50, 3], [1e30, 1e30, 1e30], [-9999] * 3])
def test_a_stray_is_far_and_the_rest_is_not(count, where):
    points = np.vstack([ball(count), [where]])
    assert np.flatnonzero(far_points(points)).tolist() == [count]


def test_up_to_a_hundredth_of_the_points_may_be_far():
    points = np.vstack([ball(1000), np.full((10, 3), 1e4), np.full((2, 3), -500.0)])
    assert np.flatnonzero(far_points(points)).tolist() == list(range(1000, 1012))


@pytest.mark.parametrize("count", [1, 2, 7])
def test_a_few_points_have_no_bulk(count):
    assert not far_points(np.geomspace(1, 1e6, count)[:, None] * np.ones(3)).any()


def test_whole_clouds_have_no_far_points():
    rng = np.random.default_rng(5)
    scan = ball(20000) * 3 * rng.pareto(2.0, size=(20000, 1)).clip(0, 60)
    for points in (
        ball(1000),
        ball(1000) * [1000, 1, 1],
        np.linspace(0, 1, 500)[:, None] * [1.0, 2.0, 3.0],
        rng.normal(size=(100_000, 3)),
        scan,
        np.vstack([ball(500), ball(500) + 1000.0]),
        np.zeros((500, 3)),
        np.vstack([np.zeros((500, 3)), [[1, 1, 1]]]),
        np.indices((2, 2, 2)).reshape(3, 8).T.astype(float),
    ):
        assert not far_points(np.asarray(points, float)).any()


def test_select_keeps_rows_together():
    cloud = sphere(50)
    part = select(cloud, np.arange(50) % 2 == 0)
    assert len(part) == 25
    assert np.array_equal(part.positions, cloud.positions[::2])
    assert np.array_equal(part.colours, cloud.colours[::2])
    assert len(part.normals) == len(part.two_sided) == 25


@pytest.mark.parametrize("value", [1e16, 1e30, 3.4e38, -1e30, 9e99])
def test_a_value_that_stands_for_no_return_is_left_out_and_the_rest_is_exact(value):
    points = ball(200)
    columns = Columns(np.vstack([points, [[value] * 3], [[value, 0.0, 0.0]]]))
    cloud = assemble_cloud(columns, "ball")
    assert cloud.dropped == {"non_finite": 0, "far_away": 2}
    assert cloud.positions + cloud.origin == pytest.approx(points, abs=1e-12)
    assert np.abs(np.sum(cloud.normals * points, axis=1)).min() > 0.9


def test_four_in_ten_points_may_stand_for_no_return():
    points = ball(600)
    columns = Columns(np.vstack([points, np.full((400, 3), 1e30)]))
    cloud = assemble_cloud(columns, "ball")
    assert cloud.dropped == {"non_finite": 0, "far_away": 400}
    assert cloud.positions + cloud.origin == pytest.approx(points, abs=1e-12)


@pytest.mark.parametrize("size", [1e-30, 1e20, 1e40, 1e90])
def test_nothing_of_a_cloud_in_an_odd_unit_is_lost(size):
    cloud = assemble_cloud(Columns(ball(100) * size), "ball")
    assert cloud.dropped == {"non_finite": 0}


def test_points_at_nearly_one_position_lose_none():
    points = np.vstack([1e-13 * ball(900), ball(100)])
    assert assemble_cloud(Columns(points), "ball").dropped == {"non_finite": 0}


def test_a_stray_does_not_move_the_origin():
    points = ball(200)
    cloud = assemble_cloud(Columns(np.vstack([points, [[1e6, 0.0, 0.0]]])), "ball")
    assert len(cloud) == 201
    assert np.abs(cloud.origin).max() < 0.1
