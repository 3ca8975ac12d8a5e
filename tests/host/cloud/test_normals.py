"""Normals estimated from the neighbourhood of each point."""

import numba
import numpy as np
import pytest

from splatline.host.cloud.normals import estimate_normals
from splatline.host.cloud.thinnest import thinnest


def degrees_between(estimated, exact):
    """Angle between lines: the sign of an estimated normal means nothing."""
    cosine = np.abs(np.sum(estimated.astype(float) * exact, axis=1))
    return np.degrees(np.arccos(np.minimum(cosine, 1.0)))


def sphere(count, seed):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def test_a_tilted_plane_has_one_exact_normal():
    rng = np.random.default_rng(1)
    normal = np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    points = rng.uniform(-1.0, 1.0, (500, 3))
    points -= np.outer(points @ normal, normal)
    estimated = estimate_normals(points)
    assert estimated.dtype == np.float32
    assert degrees_between(estimated, normal).max() < 0.05


def test_a_sphere_has_its_radii_as_normals():
    points = sphere(4000, 2)
    angles = degrees_between(estimate_normals(points), points)
    assert np.median(angles) < 1.5
    assert angles.max() < 12.0


@pytest.mark.parametrize("apart", [8, 20])
def test_lines_of_a_scanner_are_no_planes(apart):
    """Points along a line are this much closer than lines. A curve in the line's own plane, such as
    a hill's profile, says nothing of the slope across."""
    along, across = np.meshgrid(np.arange(400.0), apart * np.arange(40.0))
    x, y = along.ravel(), across.ravel()
    height = 6.0 * np.sin(x / 25.0) + 0.3 * y
    slope = 6.0 / 25.0 * np.cos(x / 25.0)
    exact = np.stack([-slope, np.full_like(x, -0.3), np.ones_like(x)], axis=1)
    exact /= np.linalg.norm(exact, axis=1, keepdims=True)
    noise = np.random.default_rng(8).normal(0.0, 0.1, len(x))
    angles = degrees_between(estimate_normals(np.stack([x, y, height + noise], axis=1)), exact)
    assert np.mean(angles > 20.0) < 0.01
    assert np.median(angles) < 5.0


def test_noise_as_thick_as_a_neighbourhood_is_averaged():
    rng = np.random.default_rng(9)
    points = rng.uniform(0.0, 100.0, (10_000, 3))  # one a square
    points[:, 2] = rng.normal(0.0, 1.5, len(points))
    angles = degrees_between(estimate_normals(points), np.array([0.0, 0.0, 1.0]))
    assert np.mean(angles > 45.0) < 0.08


def test_normals_are_of_unit_length():
    points = np.random.default_rng(3).normal(size=(300, 3))
    assert np.linalg.norm(estimate_normals(points), axis=1) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("scale", [1e-60, 1e-6, 1.0, 1e9, 1e80])
def test_the_unit_of_length_does_not_matter(scale):
    points = sphere(500, 4)
    angles = degrees_between(estimate_normals(points * scale), estimate_normals(points))
    assert angles.max() < 0.1


def test_only_the_wanted_points_are_estimated_but_all_are_neighbours():
    points = sphere(1000, 5)
    wanted = np.random.default_rng(5).random(1000) < 0.02
    some = estimate_normals(points, wanted)
    assert len(some) == np.count_nonzero(wanted)
    # With only the wanted points as neighbours the sphere would be far too coarse.
    assert np.array_equal(some, estimate_normals(points)[wanted])


def test_no_point_wanted_gives_no_normal():
    assert estimate_normals(sphere(10, 6), np.zeros(10, bool)).shape == (0, 3)


def test_copies_of_points_do_not_hide_the_surface():
    rng = np.random.default_rng(7)
    plane = np.column_stack([rng.uniform(size=(60, 2)), np.zeros(60)])
    estimated = estimate_normals(np.repeat(plane, 20, axis=0))
    assert degrees_between(estimated, np.array([0.0, 0.0, 1.0])).max() < 0.05


def test_dense_lines_of_a_scanner_are_seen_as_a_surface():
    # Forty points on a line before the next line begins: the nearest sixteen are on one line.
    x, y = np.meshgrid(np.arange(0.0, 10.0, 0.02), np.arange(0.0, 1.5, 0.3))
    plane = np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()])
    estimated = estimate_normals(plane)
    assert degrees_between(estimated, np.array([0.0, 0.0, 1.0])).max() < 0.05


@pytest.mark.parametrize("count", [1, 2, 3, 20])
def test_too_few_points_for_a_surface_still_get_unit_vectors(count):
    line = np.outer(np.arange(count), [1.0, 2.0, 3.0])
    estimated = estimate_normals(line)
    assert np.linalg.norm(estimated, axis=1) == pytest.approx(1.0, abs=1e-6)
    if count > 1:
        assert np.abs(estimated @ [1.0, 2.0, 3.0]).max() < 1e-5


def test_all_points_at_one_place_still_get_unit_vectors():
    estimated = estimate_normals(np.full((50, 3), 7.0))
    assert np.linalg.norm(estimated, axis=1) == pytest.approx(1.0, abs=1e-6)


def test_threads_do_not_show():
    points = sphere(700, 8)
    whole = estimate_normals(points)
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        assert np.array_equal(estimate_normals(points), whole)
    finally:
        numba.set_num_threads(threads)


def test_more_points_average_noise_but_not_relief():
    rng = np.random.default_rng(9)
    plane = np.column_stack([rng.random((4000, 2)), np.zeros(4000)])
    plane[:, 2] = rng.normal(scale=1.0 / np.sqrt(4000), size=4000)
    inside = np.abs(plane[:, :2] - 0.5).max(axis=1) < 0.4
    angles = degrees_between(estimate_normals(plane), np.array([0.0, 0.0, 1.0]))
    assert np.median(angles[inside]) < 10.0
    # Waves of 20 spacings, at a slope of up to 45 degrees.
    wave = np.column_stack([rng.random((4000, 2)), np.zeros(4000)])
    phase = wave[:, 0] * 2.0 * np.pi / (20.0 / np.sqrt(4000))
    wave[:, 2] = np.sin(phase) / (2.0 * np.pi) * (20.0 / np.sqrt(4000))
    exact = np.column_stack([-np.cos(phase), 0.0 * phase, np.ones_like(phase)])
    exact /= np.linalg.norm(exact, axis=1, keepdims=True)
    assert np.median(degrees_between(estimate_normals(wave), exact)) < 8.0


@pytest.mark.parametrize("seed", range(5))
def test_the_thinnest_direction_is_the_eigenvector_of_the_least_eigenvalue(seed):
    rng = np.random.default_rng(seed)
    for _ in range(40):
        extents = 10.0 ** rng.uniform(-3.0, 1.0, 3)
        around = rng.normal(size=(20, 3)) * extents @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        matrix = around.T @ around
        values, vectors = np.linalg.eigh(matrix)
        vector = np.empty(3)
        found = thinnest(matrix[np.triu_indices(3)], vector)
        assert found == pytest.approx(values, rel=1e-6, abs=1e-9 * values[2])
        if values[0] < 0.5 * values[1]:
            assert abs(vector @ vectors[:, 0]) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("stray", [(1e6, 0.0, 0.0), (-30.0, 40.0, 0.0)])
def test_a_stray_point_turns_no_normal(stray):
    rng = np.random.default_rng(8)
    sphere = rng.normal(size=(60, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    alone = estimate_normals(sphere)
    beside = estimate_normals(np.vstack([sphere, stray]))[:-1]
    right = np.abs(np.sum(alone * sphere, axis=1)), np.abs(np.sum(beside * sphere, axis=1))
    assert np.median(right[1]) > np.median(right[0]) - 0.01
