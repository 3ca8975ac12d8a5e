"""Normals estimated from the neighbourhood of each point."""

import numpy as np
import pytest

from splatline.host.cloud.normals import estimate_normals


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


def test_chunks_do_not_show(monkeypatch):
    points = sphere(700, 8)
    whole = estimate_normals(points)
    monkeypatch.setattr("splatline.host.cloud.normals.CHUNK", 64)
    assert np.array_equal(estimate_normals(points), whole)
