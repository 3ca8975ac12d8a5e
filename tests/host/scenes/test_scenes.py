"""The built-in scenes."""

import inspect

import numpy as np
import pytest
from scipy.spatial import cKDTree

from splatline.contract.errors import InputError
from splatline.host.cloud.normals import estimate_normals
from splatline.host.scenes.knot import CORAL, CREAM, GOLD, NAVY, TEAL
from splatline.host.scenes.scenes import SCENES, load_scene
from splatline.host.scenes.terrain import EXAGGERATION
from splatline.host.visibility.view import fit_view


@pytest.fixture(scope="module")
def scenes():
    return {name: load_scene(name) for name in SCENES}


def distinct_colours(cloud):
    return len(np.unique(cloud.colours, axis=0))


def agreement(cloud, count, seed):
    """Cosine between normals and estimates from the positions alone, at points taken at random."""
    wanted = np.zeros(len(cloud), bool)
    wanted[np.random.default_rng(seed).choice(len(cloud), count, replace=False)] = True
    estimated = estimate_normals(cloud.positions, wanted)
    return np.abs(np.sum(estimated * cloud.normals[wanted], axis=1))


def test_there_are_a_terrain_and_a_knot():
    assert SCENES == ("terrain", "knot")


def test_an_unknown_name_lists_the_scenes():
    with pytest.raises(InputError, match=r"no scene named 'tea pot'; there are: terrain, knot"):
        load_scene("tea pot")


@pytest.mark.parametrize(("name", "count"), [("terrain", 138_632), ("knot", 200_000)])
def test_each_scene_has_its_number_of_points(scenes, name, count):
    cloud = scenes[name].cloud
    assert len(cloud) == count
    assert cloud.name == scenes[name].name == name
    assert cloud.normals.shape == cloud.positions.shape == cloud.colours.shape == (count, 3)


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_the_same_every_time(scenes, name):
    again = load_scene(name).cloud
    for field in ("positions", "normals", "colours", "two_sided", "origin"):
        assert np.array_equal(getattr(again, field), getattr(scenes[name].cloud, field))


@pytest.mark.parametrize("name", SCENES)
def test_arrays_are_of_the_clouds_types(scenes, name):
    cloud = scenes[name].cloud
    types = (cloud.positions.dtype, cloud.normals.dtype, cloud.colours.dtype, cloud.two_sided.dtype)
    assert types == (np.float64, np.float32, np.uint8, np.bool_)
    assert np.linalg.norm(cloud.normals, axis=1) == pytest.approx(1.0, abs=1e-6)
    assert not cloud.two_sided.any()


@pytest.mark.parametrize("name", SCENES)
def test_the_origin_is_the_middle(scenes, name):
    positions = scenes[name].cloud.positions
    size = np.ptp(positions)
    assert np.abs(positions.min(axis=0) + positions.max(axis=0)).max() < 1e-9 * size


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_has_several_materials_that_fit_the_engines_table(scenes, name):
    assert 4 <= distinct_colours(scenes[name].cloud) <= 127


@pytest.mark.parametrize("name", SCENES)
def test_a_scenes_view_fits_the_whole_of_it(scenes, name):
    scene = scenes[name]
    camera = {
        key: getattr(scene, key)
        for key in inspect.signature(fit_view).parameters
        if hasattr(scene, key) and key != "cloud"
    }
    assert set(camera) == {"orbit", "fov", "up", "zoom"}
    view = fit_view(scene.cloud, **camera, size=(512, 512))
    seen = (scene.cloud.positions - view.eye) @ view.axes.T
    place = 256.0 + view.focal * seen[:, :2] / seen[:, 2:]
    assert place.min() >= 0.0
    assert place.max() <= 512.0
    assert np.ptp(place, axis=0).max() > 450.0  # and fills it


class TestTerrain:
    def test_heights_and_extent_are_in_metres(self, scenes):
        positions = scenes["terrain"].cloud.positions
        east, north, up = np.ptp(positions, axis=0)
        assert up == pytest.approx(EXAGGERATION * (1076 - 236))
        # 402 and 343 steps of 3 arc seconds at 36.59 degrees of latitude; 30.92 m is a second.
        assert east == pytest.approx(402 * 3 * 30.92 * np.cos(np.radians(36.59)), rel=0.01)
        assert north == pytest.approx(343 * 3 * 30.92, rel=0.01)

    def test_the_ridge_of_the_north_west_is_where_it_is_on_a_map(self, scenes):
        # Cumberland Mountain's plateau lies to the west of the Powell and Clinch valleys.
        positions = scenes["terrain"].cloud.positions
        east, south = positions[:, 0] > 0.0, positions[:, 1] < 0.0
        assert positions[~east & south, 2].mean() > positions[east & south, 2].mean() + 500.0

    def test_normals_point_up_and_follow_the_slope(self, scenes):
        cloud = scenes["terrain"].cloud
        assert cloud.normals[:, 2].min() > 0.0
        cosine = agreement(cloud, 4000, 1)
        assert np.median(cosine) > np.cos(np.radians(7.0))
        assert np.percentile(cosine, 1) > np.cos(np.radians(35.0))

    def test_one_height_has_one_colour(self, scenes):
        cloud = scenes["terrain"].cloud
        height = np.rint(cloud.positions[:, 2] * 1e3).astype(np.int64)
        _, group = np.unique(height, return_inverse=True)
        first = np.full(group.max() + 1, -1)
        first[group[::-1]] = np.arange(len(group))[::-1]
        assert np.array_equal(cloud.colours, cloud.colours[first[group]])


class TestKnot:
    def test_normals_have_every_direction(self, scenes):
        normals = scenes["knot"].cloud.normals
        rng = np.random.default_rng(2)
        probes = rng.normal(size=(2000, 3))
        probes /= np.linalg.norm(probes, axis=1, keepdims=True)
        distance, _ = cKDTree(normals).query(probes)
        assert distance.max() < np.radians(2.0)

    def test_normals_are_those_of_the_surface(self, scenes):
        cosine = agreement(scenes["knot"].cloud, 4000, 3)
        assert np.percentile(cosine, 1) > np.cos(np.radians(5.0))

    @pytest.mark.parametrize("colours", [(CORAL, CREAM), (GOLD,), (TEAL, NAVY)])
    def test_normals_point_out_of_closed_surfaces(self, scenes, colours):
        # The divergence theorem: over evenly spread points of closed surfaces the mean of n is 0,
        # and the mean of p . n times the area is three times the volume: above 0 if n points out.
        cloud = scenes["knot"].cloud
        part = np.isin(cloud.colours, colours).all(axis=1)
        assert np.count_nonzero(part) > 1000
        positions, normals = cloud.positions[part], cloud.normals[part]
        assert np.abs(normals.mean(axis=0)).max() < 2e-3
        assert np.mean(np.sum(positions * normals, axis=1)) > 0.05

    def test_points_are_evenly_spread(self, scenes):
        # With the same density everywhere, the fortieth neighbour is equally far everywhere.
        tree = cKDTree(scenes["knot"].cloud.positions)
        distance, _ = tree.query(tree.data, [2, 41])
        nearest, fortieth = (distance / np.median(distance, axis=0)).T
        low, high = np.percentile(fortieth, [1, 99])
        assert 0.94 < low < high < 1.06
        assert nearest.min() > 0.25  # and no two clump

    def test_surfaces_keep_clear_of_each_other(self, scenes):
        # Where two cut, points of very different normals would be neighbours.
        cloud = scenes["knot"].cloud
        _, index = cKDTree(cloud.positions).query(cloud.positions, 2)
        cosine = np.sum(cloud.normals * cloud.normals[index[:, 1]], axis=1)
        assert cosine.min() > 0.95
