"""The radii at which discs close a surface."""

import time

import numba
import numpy as np
import pytest
from scipy.spatial import Delaunay

from splatline.contract.errors import InputError
from splatline.host.cloud.closing import OBTUSE
from splatline.host.cloud.spacing import COVER, closing_radii, measure_discs, splat_radii
from splatline.host.files.assemble import Columns, assemble_cloud


def grid(side, step=1.0):
    x, y = np.meshgrid(np.arange(side) * step, np.arange(side) * step)
    return np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()])


def inner(values, side, rim=3):
    """Values of a grid's points away from its border."""
    return values.reshape(side, side)[rim:-rim, rim:-rim]


def up(positions):
    return np.tile(np.float32([0.0, 0.0, 1.0]), (len(positions), 1))


def flat(positions):
    """Closing radii of points of a horizontal surface."""
    return closing_radii(np.asarray(positions, float), up(positions))


def uncovered(positions, radii, probes):
    """Share of the probes that no disc of a horizontal plane holds."""
    gaps = np.linalg.norm(probes[:, None, :2] - positions[:, :2], axis=2) > radii
    return gaps.all(axis=1).mean()


def cloud_of(positions):
    normals = np.tile([0.0, 0.0, 1.0], (len(positions), 1))
    return assemble_cloud(Columns(positions, normals), "test")


def test_a_square_grid_is_closed_at_half_its_diagonal():
    assert inner(flat(grid(20, 0.25)), 20) == pytest.approx(0.25 * np.sqrt(0.5))


def test_a_grid_seen_along_its_plane_needs_no_more():
    # Turned by any rotation, the grid is the same in its tangent plane.
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    radii = closing_radii(grid(20) @ turn.T, up(grid(20)) @ turn.T.astype(np.float32))
    assert inner(radii, 20) == pytest.approx(np.sqrt(0.5), rel=1e-5)


def test_random_points_of_a_plane_are_covered():
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.random((5000, 2)), np.zeros(5000)])
    probes = rng.uniform(0.05, 0.95, (3000, 2))
    radii = flat(points)
    assert uncovered(points, radii, probes) < 0.02
    assert uncovered(points, COVER * radii, probes) < 0.001
    # Hardly larger than a square grid's of that density would have to be.
    assert np.median(radii) < 1.5 * np.sqrt(0.5 / 5000)


@pytest.mark.parametrize("apart", [2, 5, 8])
def test_lines_of_a_scanner_are_closed(apart):
    rng = np.random.default_rng(2)
    x, y = np.meshgrid(np.arange(120.0), np.arange(0.0, 120.0, apart))
    points = np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()])
    points[:, :2] += rng.normal(scale=0.2, size=(len(points), 2))
    probes = rng.uniform(20.0, 100.0, (2000, 2))
    assert uncovered(points, COVER * flat(points), probes) < 0.001


def test_a_border_stays_where_it_is():
    rng = np.random.default_rng(3)
    points = np.column_stack([rng.random((5000, 2)), np.zeros(5000)])
    radii = COVER * flat(points)
    rim = np.abs(points[:, :2] - 0.5).max(axis=1) > 0.5 - 0.5 / np.sqrt(5000)
    assert np.median(radii[rim]) < 1.2 * np.median(radii)


def test_noise_across_the_surface_makes_discs_no_smaller():
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.random((5000, 2)), np.zeros(5000)])
    still = np.median(flat(points))
    for noise in (0.5, 2.0):
        points[:, 2] = rng.normal(scale=noise / np.sqrt(5000), size=5000)
        assert still < np.median(flat(points)) < 1.7 * still


def corners_of(points):
    """Of each triangle, by scipy: its points, the cosines of their angles, and its circumradius."""
    simplices = Delaunay(points).simplices
    one, two, three = (points[simplices[:, k]] for k in range(3))
    a, b, c = (np.linalg.norm(side, axis=1) for side in (two - three, three - one, one - two))
    turns = (a, b, c), (b, c, a), (c, a, b)
    cosines = [(y * y + z * z - x * x) / (2 * y * z) for x, y, z in turns]
    area = 0.25 * np.sqrt((a + b + c) * (b + c - a) * (c + a - b) * (a + b - c))
    return simplices, np.column_stack(cosines), a * b * c / (4.0 * area)


def furthest(count, corners, counts):
    """Of each point the furthest of its corners that count; 0: none."""
    simplices, _, radii = corners
    found = np.zeros(count)
    np.maximum.at(found, simplices[counts], np.broadcast_to(radii[:, None], counts.shape)[counts])
    return found


def test_the_radii_are_those_of_scipys_voronoi_regions():
    """But where a gap is so large that a point beyond it is in no cell about the point."""
    points = np.random.default_rng(8).random((3000, 2))
    radii = flat(np.column_stack([points, np.zeros(3000)]))
    inside = (np.abs(points - 0.5) < 0.4).all(axis=1)
    nearest = np.sort(np.linalg.norm(points[:, None] - points, axis=2), axis=1)[:, 1]
    corners = corners_of(points)
    cosines = corners[1]
    acute = np.broadcast_to((cosines >= -OBTUSE).all(axis=1)[:, None], cosines.shape)
    least = np.maximum(furthest(3000, corners, acute), np.sqrt(0.5) * nearest)
    own = np.maximum(furthest(3000, corners, cosines >= -OBTUSE), least)
    assert np.mean(np.abs(radii / own - 1.0)[inside] < 1e-3) > 0.97
    assert np.mean((radii / least)[inside] > 1.0 - 1e-3) > 0.99
    assert np.mean((radii / own)[inside] < 1.0 + 1e-3) > 0.99


def test_nearly_every_gap_is_reached_by_a_disc():
    points = np.random.default_rng(9).random((20_000, 2))
    radii = flat(np.column_stack([points, np.zeros(20_000)]))
    simplices, _, needed = corners_of(points)
    inside = (np.abs(points - 0.5) < 0.45).all(axis=1)[simplices].all(axis=1)
    is_open = radii[simplices].max(axis=1) < 0.9 * needed
    assert np.count_nonzero(is_open & inside) <= 1


def test_a_layer_that_faces_the_other_way_does_not_close_gaps():
    layer = grid(20)
    other = layer + np.array([0.4, 0.5, -0.2])
    normals = np.concatenate([up(layer), -up(other)])
    points = np.concatenate([layer, other])
    both = measure_discs(assemble_cloud(Columns(points, normals), "test")).radii
    alone = measure_discs(assemble_cloud(Columns(layer, up(layer)), "test")).radii
    assert (inner(both[:400], 20) > 0.9 * inner(alone, 20)).all()
    unsigned = inner(closing_radii(points, up(points))[:400], 20) * COVER
    assert (unsigned < 0.75 * inner(alone, 20)).all()


@pytest.mark.parametrize("gap", [0.5, 1.0, 3.0])
def test_a_second_layer_makes_discs_hardly_smaller(gap):
    layer = grid(20)
    other = layer + np.array([0.3, 0.4, gap])
    radii = inner(flat(np.concatenate([layer, other]))[:400], 20)
    assert (radii > 0.8 * np.sqrt(0.5)).all()


def test_the_radius_follows_the_density():
    sparse = grid(20, 1.0)
    dense = grid(20, 0.1) + np.array([100.0, 0.0, 0.0])
    radii = flat(np.concatenate([sparse, dense]))
    assert inner(radii[:400], 20) == pytest.approx(10.0 * inner(radii[400:], 20))


def test_a_stray_point_gets_a_disc_like_those_it_strayed_from():
    points = np.concatenate([grid(20), [[10.0, 10.0, 500.0]]])
    radii = flat(points)
    assert radii[-1] < 3.0
    assert inner(radii[:-1], 20) == pytest.approx(inner(flat(grid(20)), 20))


def test_a_few_points_far_away_do_not_spoil_the_others():
    points = np.concatenate([grid(60), [[1e7, 0.0, 0.0], [0.0, -1e8, 0.0]]])
    assert inner(flat(points)[:-2], 60) == pytest.approx(np.sqrt(0.5), rel=1e-4)


@pytest.mark.parametrize("copies", [2, 30])
def test_copies_of_points_change_nothing(copies):
    points = np.random.default_rng(2).normal(size=(300, 3))
    order = np.random.default_rng(3).permutation(300 * copies)
    repeated = np.repeat(points, copies, axis=0)[order]
    expected = np.repeat(flat(points), copies)[order]
    assert flat(repeated) == pytest.approx(expected)


def test_many_returns_at_one_position_take_no_longer():
    rng = np.random.default_rng(5)
    points = np.concatenate([np.zeros((60_000, 3)), rng.normal(size=(3000, 3))])
    flat(points[:100])  # compiles
    begin = time.process_time()
    radii = flat(points)
    assert time.process_time() - begin < 2.0
    assert np.isfinite(radii).all() and (radii > 0.0).all()


@pytest.mark.parametrize("scale", [1e-60, 1e-3, 1e7, 1e80])
def test_the_radius_has_the_clouds_unit(scale):
    points = np.random.default_rng(4).normal(size=(200, 3))
    assert flat(points * scale) == pytest.approx(flat(points) * scale)


def test_points_on_a_line_get_discs_that_touch():
    radii = flat(np.outer(np.arange(40), [2.0, 0.0, 0.0]))
    assert ((radii >= 1.0) & (radii < 3.0)).all()


@pytest.mark.parametrize("count", [2, 3, 8])
def test_few_points_get_discs_that_do_not_touch(count):
    radii = COVER * flat(np.outer(np.arange(count), [2.0, 0.0, 0.0]))
    assert ((radii > 0.5) & (radii < 1.0)).all()


@pytest.mark.parametrize("count", [1, 5])
def test_a_single_place_gets_a_disc_all_the_same(count):
    assert flat(np.zeros((count, 3))) == pytest.approx(0.01)


def test_points_above_each_other_get_discs_all_the_same():
    radii = flat(np.outer(np.arange(100), [0.0, 0.0, 1.0]))
    assert np.isfinite(radii).all() and (radii > 0.0).all()


def test_threads_and_the_order_of_points_do_not_show():
    points = np.random.default_rng(5).normal(size=(3000, 3))
    whole = flat(points)
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        assert np.array_equal(flat(points), whole)
    finally:
        numba.set_num_threads(threads)
    order = np.random.default_rng(6).permutation(3000)
    assert np.array_equal(flat(points[order]), whole[order])


def test_a_given_size_is_every_discs_diameter():
    radii = splat_radii(cloud_of(grid(5)), 0.3)
    assert radii.shape == (25,)
    assert (radii == 0.15).all()


def test_the_radius_is_the_closing_radius_times_a_constant():
    cloud = cloud_of(np.random.default_rng(6).normal(size=(100, 3)))
    assert splat_radii(cloud) == pytest.approx(
        COVER * closing_radii(cloud.positions, cloud.normals)
    )


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_a_size_that_is_none_is_refused(size):
    with pytest.raises(InputError, match="splat size must be above 0"):
        splat_radii(cloud_of(grid(3)), size)
