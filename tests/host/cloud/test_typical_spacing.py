import numpy as np
import pytest

from splatline import host
from splatline.host.cloud import typical_spacing
from splatline.host.cloud.typical_spacing import typical_size
from splatline.host.files.assemble import Columns, assemble_cloud


def sphere(count, seed=2):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def exact(cloud):
    return 2.0 * np.median(host.splat_radii(cloud))


def test_a_small_cloud_is_measured_as_a_whole():
    cloud = assemble_cloud(Columns(sphere(3000), sphere(3000)), "ball")
    assert typical_size(cloud) == exact(cloud)


@pytest.mark.parametrize("normals", [True, False])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e6])
def test_a_large_cloud_is_measured_in_parts(monkeypatch, normals, scale):
    monkeypatch.setattr(typical_spacing, "LARGE", 10_000)
    points = sphere(60_000)
    cloud = assemble_cloud(Columns(scale * points, points if normals else None), "ball")
    bare = assemble_cloud(
        Columns(scale * points, points if normals else None), "ball", estimate=False
    )
    kept = bare.normals.copy()
    assert typical_size(bare) == pytest.approx(exact(cloud), rel=0.05)
    assert np.array_equal(bare.normals, kept)
    assert bare.two_sided.any() != normals


@pytest.mark.parametrize("count", [300_000, 600_000])
def test_parts_hold_the_same_number_of_points_whatever_the_cloud_has(count):
    inside = int(typical_spacing._in_boxes(sphere(count)).sum())
    assert 0.1 < inside / (typical_spacing.PARTS * typical_spacing.PART_POINTS) < 2.0


@pytest.mark.parametrize("shape", ["one place", "line", "stray"])
def test_odd_clouds_have_a_size(monkeypatch, shape):
    monkeypatch.setattr(typical_spacing, "LARGE", 1000)
    points = np.zeros((5000, 3))
    if shape == "line":
        points[:, 0] = np.arange(5000)
    elif shape == "stray":
        points = sphere(5000)
        points[7] = 1e9
    cloud = assemble_cloud(Columns(points), "odd", estimate=False)
    size = typical_size(cloud)
    assert np.isfinite(size)
    assert size > 0.0
    if shape == "stray":
        assert size == pytest.approx(exact(assemble_cloud(Columns(sphere(5000)), "ball")), rel=0.1)
