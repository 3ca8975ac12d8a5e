"""Normals of noisy clouds are smooth, and those of others stay as they were estimated."""

import numpy as np
import pytest

from splatline.host.cloud import measure_cells
from splatline.host.cloud.normals import estimate_normals

UP = np.array([0.0, 0.0, 1.0])


def degrees_between(estimated, exact):
    cosine = np.abs(np.sum(estimated.astype(float) * exact, axis=1))
    return np.degrees(np.arccos(np.minimum(cosine, 1.0)))


def rough(positions, monkeypatch):
    """Normals as they are estimated, before any is smoothed."""
    with monkeypatch.context() as patch:
        patch.setattr(measure_cells, "is_noisy", lambda shares: False)
        return estimate_normals(positions)


def plane(noise, count=10_000, seed=1):
    """Points of a plane, one a square, with noise in spacings."""
    rng = np.random.default_rng(seed)
    side = np.sqrt(count)
    flat = rng.uniform(0.0, side, (count, 2))
    return np.column_stack([flat, rng.normal(0.0, noise, count) if noise else np.zeros(count)])


def sphere(noise, count=20_000, seed=2):
    """Points of a sphere with noise in spacings, and their true normals."""
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    spacing = np.sqrt(4.0 * np.pi / count)
    return normals * (1.0 + noise * spacing * rng.normal(size=(count, 1))), normals


def fold(count=20_000, seed=3):
    """A pleated sheet without noise: each pleat is eight spacings wide, at right angles."""
    rng = np.random.default_rng(seed)
    side = np.sqrt(count)
    x, y = rng.uniform(0.0, side, (2, count))
    return np.column_stack([x, y, np.abs(x % 16.0 - 8.0)])


@pytest.mark.parametrize("noise", [0.7, 1.5])
def test_a_noisy_plane_is_smooth(noise, monkeypatch):
    points = plane(noise)
    before = degrees_between(rough(points, monkeypatch), UP)
    after = degrees_between(estimate_normals(points), UP)
    assert after.mean() < 0.62 * before.mean()
    assert np.mean(after > 45.0) <= 0.25 * np.mean(before > 45.0)


def test_a_noisy_sphere_is_smooth(monkeypatch):
    points, exact = sphere(0.7)
    before = degrees_between(rough(points, monkeypatch), exact)
    after = degrees_between(estimate_normals(points), exact)
    assert after.mean() < 0.62 * before.mean()
    assert after.max() < 45.0


def test_a_clean_fold_stays_as_it_is(monkeypatch):
    points = fold()
    assert np.array_equal(estimate_normals(points), rough(points, monkeypatch))


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.1])
def test_a_clean_sphere_stays_as_it_is(noise, monkeypatch):
    points, _ = sphere(noise)
    assert np.array_equal(estimate_normals(points), rough(points, monkeypatch))


def test_noise_of_one_part_alone_is_not_smoothed(monkeypatch):
    """A tree on a lawn: what is flat shows that the scanner has little noise."""
    points = np.concatenate([plane(1.0), plane(0.0) + np.array([500.0, 0.0, 0.0])])
    assert np.array_equal(estimate_normals(points), rough(points, monkeypatch))


def test_few_points_stay_as_they_are(monkeypatch):
    points = np.random.default_rng(4).normal(size=(900, 3))
    assert np.array_equal(estimate_normals(points), rough(points, monkeypatch))
    more = np.random.default_rng(4).normal(size=(1100, 3))
    assert not np.array_equal(estimate_normals(more), rough(more, monkeypatch))


def test_normals_that_are_not_wanted_count_in_the_means_of_others():
    points = plane(1.0)
    wanted = np.random.default_rng(5).random(len(points)) < 0.02
    assert np.array_equal(estimate_normals(points, wanted), estimate_normals(points)[wanted])


def test_smooth_normals_are_of_unit_length():
    for points in (plane(1.0), np.random.default_rng(6).normal(size=(3000, 3))):
        lengths = np.linalg.norm(estimate_normals(points), axis=1)
        assert lengths == pytest.approx(1.0, abs=1e-6)


def test_a_mean_has_no_sign():
    """The axes of neighbours cancel nowhere, whatever their signs are."""
    points = plane(1.0) @ np.linalg.qr(np.random.default_rng(7).normal(size=(3, 3)))[0]
    assert degrees_between(estimate_normals(points), np.cross(*_edges(points))).mean() < 12.0


def _edges(points):
    """Two axes along the plane of points."""
    return np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][:2]
