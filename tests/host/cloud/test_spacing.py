"""The spacing of points, and the radii of their discs."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.cloud.spacing import COVER, point_spacing, splat_radii
from splatline.host.files.assemble import Columns, assemble_cloud


def grid(side, step=1.0):
    x, y = np.meshgrid(np.arange(side) * step, np.arange(side) * step)
    return np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()])


def inner(values, side, rim=3):
    """Values of a grid's points away from its border."""
    return values.reshape(side, side)[rim:-rim, rim:-rim]


def cloud_of(positions):
    normals = np.tile([0.0, 0.0, 1.0], (len(positions), 1))
    return assemble_cloud(Columns(positions, normals), "test")


def test_a_square_grid_has_nearly_its_step():
    # The eighth neighbour is at a diagonal: sqrt(2) step; the area a point has, 2 pi step^2 / 8.
    spacing = inner(point_spacing(grid(20, 0.25)), 20)
    assert spacing == pytest.approx(0.25 * np.sqrt(2.0 * np.pi / 8.0))


def test_discs_of_a_square_grid_leave_no_hole():
    radii = inner(splat_radii(cloud_of(grid(20))), 20)
    assert (radii > np.sqrt(0.5)).all()  # the middle of four points
    assert (radii < 1.2).all()


def test_random_points_of_a_plane_are_nearly_all_covered():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.random((5000, 2)), np.zeros(5000)])
    cloud = cloud_of(points)
    radii = splat_radii(cloud)
    probes = np.column_stack([rng.uniform(0.05, 0.95, (3000, 2)), np.zeros(3000)]) - cloud.origin
    gaps = np.linalg.norm(probes[:, None] - cloud.positions, axis=2) > radii
    assert gaps.all(axis=1).mean() < 0.05


def test_the_spacing_follows_the_density():
    sparse = grid(20, 1.0)
    dense = grid(20, 0.1) + np.array([100.0, 0.0, 0.0])
    spacing = point_spacing(np.concatenate([sparse, dense]))
    assert inner(spacing[:400], 20) == pytest.approx(10.0 * inner(spacing[400:], 20))


def test_a_stray_point_gets_a_disc_like_those_it_strayed_from():
    points = np.concatenate([grid(20), [[10.0, 10.0, 500.0]]])
    spacing = point_spacing(points)
    assert spacing[-1] < 3.0
    assert inner(spacing[:-1], 20) == pytest.approx(inner(point_spacing(grid(20)), 20))


@pytest.mark.parametrize("copies", [2, 30])
def test_copies_of_points_change_nothing(copies):
    points = np.random.default_rng(2).normal(size=(300, 3))
    order = np.random.default_rng(3).permutation(300 * copies)
    repeated = np.repeat(points, copies, axis=0)[order]
    expected = np.repeat(point_spacing(points), copies)[order]
    assert point_spacing(repeated) == pytest.approx(expected)


@pytest.mark.parametrize("scale", [1e-60, 1e-3, 1e7, 1e80])
def test_the_spacing_has_the_clouds_unit(scale):
    points = np.random.default_rng(4).normal(size=(200, 3))
    assert point_spacing(points * scale) == pytest.approx(point_spacing(points) * scale)


@pytest.mark.parametrize("count", [2, 3, 8])
def test_a_few_points_get_discs_about_as_large_as_their_distance(count):
    spacing = point_spacing(np.outer(np.arange(count), [2.0, 0.0, 0.0]))
    assert ((spacing > 1.0) & (spacing < 10.0)).all()


@pytest.mark.parametrize("count", [1, 5])
def test_a_single_place_gets_a_disc_all_the_same(count):
    assert point_spacing(np.zeros((count, 3))) == pytest.approx(0.01)


def test_chunks_do_not_show(monkeypatch):
    points = np.random.default_rng(5).normal(size=(500, 3))
    whole = point_spacing(points)
    monkeypatch.setattr("splatline.host.cloud.spacing.CHUNK", 64)
    assert np.array_equal(point_spacing(points), whole)


def test_a_given_size_is_every_discs_diameter():
    radii = splat_radii(cloud_of(grid(5)), 0.3)
    assert radii.shape == (25,)
    assert (radii == 0.15).all()


def test_the_radius_is_the_spacing_times_a_constant():
    cloud = cloud_of(np.random.default_rng(6).normal(size=(100, 3)))
    assert splat_radii(cloud) == pytest.approx(COVER * point_spacing(cloud.positions))


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_a_size_that_is_none_is_refused(size):
    with pytest.raises(InputError, match="splat size must be above 0"):
        splat_radii(cloud_of(grid(3)), size)
