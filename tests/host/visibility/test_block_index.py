import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.host.visibility.block_index import BLOCK_POINTS, build_index
from splatline.host.visibility.groups import GROUP_POINTS
from tests.support.clouds import cloud_of, sphere


def of_blocks(index, field):
    """A field of its block's bounds for each point."""
    return np.repeat(index.bounds[field], BLOCK_POINTS, axis=0)[: len(index)]


def discs_of(index):
    """The discs as rows: shape (7, n)."""
    return index.discs.transpose(1, 0, 2).reshape(7, -1)[:, : len(index)]


def positions_of(index):
    return of_blocks(index, "centre") + of_blocks(index, "reach")[:, None] * discs_of(index)[:3].T


def radii_of(index):
    return of_blocks(index, "largest") * np.abs(discs_of(index)[3])


def test_it_holds_every_point_once_with_all_that_is_its_own():
    cloud = sphere(1000)
    radii = np.arange(1000.0)
    index = build_index(cloud, radii)
    assert sorted(index.point) == list(range(1000))
    assert np.array_equal(index.points["position"], cloud.positions[index.point])
    assert np.array_equal(index.points["radius"], radii[index.point])
    assert np.allclose(positions_of(index), index.points["position"], rtol=0, atol=1e-6)
    assert np.array_equal(discs_of(index)[4:].T, cloud.normals[index.point])
    assert np.allclose(radii_of(index), index.points["radius"], rtol=1e-6)
    colours = index.materials.palette[index.materials.index]
    assert np.array_equal(colours, cloud.colours[index.point])


def test_it_takes_no_more_than_84_bytes_a_point():
    cloud = sphere(5000)
    assert build_index(cloud, np.ones(5000)).nbytes <= 84 * 5000


@given(st.integers(0, 2**32 - 1), st.integers(-9, 9), st.integers(1, 600))
@settings(max_examples=40, deadline=None)
def test_bounds_hold_their_points(seed, magnitude, count):
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(count, 3)) * 0.4 + [0, 0, 1]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cloud = cloud_of(rng.normal(size=(count, 3)) * 10.0**magnitude, normals)
    radii = rng.uniform(0, 1, count)
    index = build_index(cloud, radii)
    assert len(index.bounds) == -(-count // BLOCK_POINTS)
    for number, bound in enumerate(index.bounds):
        part = slice(number * BLOCK_POINTS, (number + 1) * BLOCK_POINTS)
        points = index.point[part]
        far = np.linalg.norm(cloud.positions[points] - bound["centre"], axis=1)
        assert far.max() <= bound["reach"]
        assert radii[points].max() == bound["largest"]
        assert np.abs(discs_of(index)[:4, part]).max() <= 1.0
        if bound["sine"] <= 1.0:
            cosine = discs_of(index)[4:, part].T.astype(float) @ bound["axis"]
            assert cosine.min() >= np.sqrt(1 - bound["sine"] ** 2)


@given(st.integers(0, 2**32 - 1), st.integers(-9, 9), st.integers(1, 600))
@settings(max_examples=40, deadline=None)
def test_groups_hold_the_discs_of_their_points(seed, magnitude, count):
    rng = np.random.default_rng(seed)
    cloud = cloud_of(rng.normal(size=(count, 3)) * 10.0**magnitude, [[0, 0, 1]] * count)
    radii = rng.uniform(0, 1, count) * 10.0**magnitude
    thin = rng.random(count) < 0.02
    index = build_index(cloud, radii, None, thin)
    for start in range(0, count, GROUP_POINTS):
        bound, at = index.bounds[start // BLOCK_POINTS], start % BLOCK_POINTS // GROUP_POINTS
        *middle, reach = index.groups[start // BLOCK_POINTS, :, at].astype(float)
        points = index.point[start : start + GROUP_POINTS]
        away = cloud.positions[points] - bound["centre"] - np.array(middle) * bound["reach"]
        far = np.linalg.norm(away, axis=1) + radii[points]
        assert np.isinf(reach) == (thin[points].any() or bound["reach"] == 0.0)
        assert np.isinf(reach) or far.max() <= reach * bound["reach"]


def test_a_disc_tells_whether_its_point_is_thin_or_two_sided():
    cloud = cloud_of(np.eye(3), [[0, 0, 1]] * 3, two_sided=True)
    index = build_index(cloud, np.ones(3), None, np.array([True, False, False]))
    shares = discs_of(index)[3]
    assert (shares < 0.0).all()
    assert np.array_equal(np.isinf(shares), index.points["thin"])


def test_blocks_are_small_and_their_cones_narrow():
    index = build_index(sphere(20_000), np.ones(20_000))
    # 128 of 20,000 points on a unit sphere take 0.08 of its area: a patch of radius 0.16.
    assert np.median(index.bounds["reach"]) < 0.35
    assert np.median(index.bounds["sine"]) < 0.35


def test_two_sided_points_have_no_cone():
    cloud = cloud_of(np.zeros((3, 3)), [[0, 0, 1]] * 3, two_sided=True)
    assert build_index(cloud, np.ones(3)).bounds["sine"][0] == 2.0


@pytest.mark.parametrize("radii", [np.ones(9), np.full(10, -1.0), np.full(10, np.nan)])
def test_bad_radii_are_refused(radii):
    with pytest.raises(InputError, match="radius"):
        build_index(sphere(10), radii)
