import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.scenes.scenes import SCENES, load_scene
from splatline.host.visibility.view import check_view, fit_view
from tests.support.clouds import cloud_of, sphere


def on_image(cloud, view):
    camera = (cloud.positions - view.eye) @ view.axes.T
    assert (camera[:, 2] > view.near).all()
    column = view.width / 2 + view.focal * camera[:, 0] / camera[:, 2]
    line = view.height / 2 + view.focal * camera[:, 1] / camera[:, 2]
    return column, line


@pytest.mark.parametrize("size", [(512, 512), (300, 100), (64, 200)])
@pytest.mark.parametrize("fov", [0.1, 35.0, 100.0, 170.0])
def test_the_cloud_fits_the_image_and_nearly_fills_it(size, fov):
    rng = np.random.default_rng(3)
    for up in ("x", "y", "z", "-z"):
        points = rng.normal(size=(500, 3)) * rng.uniform(0.1, 3, 3)
        cloud = cloud_of(points, points)
        orbit = (rng.uniform(-180, 180), rng.uniform(-90, 90))
        view = fit_view(cloud, size=size, fov=fov, orbit=orbit, up=up)
        column, line = on_image(cloud, view)
        assert 0 <= column.min() <= column.max() <= size[0]
        assert 0 <= line.min() <= line.max() <= size[1]
        fill = max(np.ptp(column) / size[0], np.ptp(line) / size[1])
        if fov < 60:  # a wider eye must stop in front of the cloud before it fills the image
            assert fill > 0.85


def box_on_image(cloud, view):
    """Return the least and the greatest pixel coordinates: two of shape (2,)."""
    pixels = np.stack(on_image(cloud, view))
    return pixels.min(axis=1), pixels.max(axis=1)


SHAPES = {
    "flat": (10, 10, 0.3),
    "wide": (10, 1, 1),
    "tall": (1, 1, 10),
    "cube": (3, 3, 3),
    "wall": (10, 0.3, 6),
}


@pytest.mark.parametrize("size", [(512, 512), (1024, 256), (200, 900)])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_image_of_a_box_is_in_the_middle_and_touches_the_margin(shape, size):
    corners = np.stack(np.meshgrid(*[(-0.5, 0.5)] * 3), axis=-1).reshape(8, 3) * SHAPES[shape]
    inside = np.random.default_rng(1).uniform(-0.5, 0.5, (200, 3)) * SHAPES[shape]
    cloud = cloud_of(np.concatenate([corners, inside]) + np.array([7, -3, 2]), np.ones((208, 3)))
    for azimuth in range(0, 360, 30):
        for elevation in (-90, -60, 0, 20, 48, 80):
            view = fit_view(cloud, size=size, orbit=(azimuth, elevation), up="z")
            low, high = box_on_image(cloud, view)
            assert np.allclose(0.5 * (low + high), np.array(size) / 2, atol=0.05)
            # The eye stands off a long cloud, which may leave more room than the margin.
            assert 0.4 < ((high - low) / size).max() <= 1 / 1.06 + 1e-9


@pytest.mark.parametrize("elevation", [5, 20, 60])
def test_the_image_of_many_points_is_in_the_middle(elevation):
    """They are more than the sample by which the middle is found."""
    points = np.random.default_rng(1).normal(size=(200_000, 3)) * (3, 2, 0.3)
    cloud = cloud_of(points, np.ones_like(points))
    view = fit_view(cloud, orbit=(25, elevation), up="z")
    low, high = box_on_image(cloud, view)
    assert np.allclose(0.5 * (low + high), 256, atol=0.5)
    assert ((high - low) / 512).max() == pytest.approx(1 / 1.06)


def test_a_view_of_the_same_points_is_the_same():
    points = np.random.default_rng(2).normal(size=(100_000, 3))
    cloud = cloud_of(points, points)
    assert np.array_equal(fit_view(cloud).eye, fit_view(cloud).eye)


@pytest.mark.parametrize("name", SCENES)
def test_scenes_are_in_the_middle(name):
    scene = load_scene(name)
    view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, zoom=scene.zoom)
    low, high = box_on_image(scene.cloud, view)
    assert np.allclose(0.5 * (low + high), 256, atol=0.5)


def test_axes_are_orthonormal_and_turn_with_the_orbit():
    view = fit_view(sphere(50), orbit=(0, 0), up="y")
    assert np.allclose(view.axes @ view.axes.T, np.eye(3))
    assert np.linalg.det(view.axes) == pytest.approx(1.0)
    assert np.allclose(view.axes, [[1, 0, 0], [0, -1, 0], [0, 0, -1]])  # from +z, y up
    side = fit_view(sphere(50), orbit=(90, 0), up="y")
    assert np.allclose(side.axes[2], [-1, 0, 0])  # from +x
    above = fit_view(sphere(50), orbit=(0, 90), up="y")
    assert np.allclose(above.axes[2], [0, -1, 0])


def test_a_single_place_can_be_looked_at():
    view = fit_view(cloud_of([[0, 0, 0]] * 3, [[0, 0, 1]] * 3))
    column, line = on_image(cloud_of([[0, 0, 0]], [[0, 0, 1]]), view)
    assert column[0] == pytest.approx(view.width / 2)
    assert line[0] == pytest.approx(view.height / 2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fov": 0.0}, "at least 1e-05 and below 180"),
        ({"fov": float("nan")}, "at least 1e-05 and below 180"),
        ({"size": (0, 5)}, "at least one pixel"),
        ({"up": "w"}, "x, y, z"),
        ({"zoom": 0.0}, "zoom"),
        ({"zoom": 1e98}, "a zoom of 1e.98 does not go with a field of view"),
        ({"fov": 180.0 - 1e-9}, "a zoom of 1 does not go with a field of view of 180 degrees"),
        ({"orbit": (float("inf"), 0.0)}, "orbit"),
    ],
)
def test_bad_parameters_are_named(options, message):
    with pytest.raises(InputError, match=message):
        fit_view(sphere(10), **options)


def test_a_poster_of_a_detail_is_no_error():
    """Few points of it are in view, but its numbers are far from what float64 holds."""
    view = fit_view(sphere(10), size=(16384, 16384), zoom=1e5)
    assert view.focal > 1e9
    check_view(view)


@pytest.mark.parametrize("count", [1, 2, 3, 5, 10])
@pytest.mark.parametrize("radius", [0.01, 1.0, 30.0])
@pytest.mark.parametrize("size", [(512, 512), (300, 100)])
def test_discs_of_a_few_points_are_in_view(count, radius, size):
    rng = np.random.default_rng(count)
    points = rng.normal(size=(count, 3))
    cloud = cloud_of(points, points)
    radii = rng.uniform(0.5, 1.0, count) * radius
    view = fit_view(cloud, size=size, radii=radii)
    for direction in rng.normal(size=(200, 3)):
        edge = radii[:, None] * direction / np.linalg.norm(direction)
        column, line = on_image(cloud_of(points + edge, points), view)
        assert -1e-6 <= column.min() <= column.max() <= size[0] + 1e-6
        assert -1e-6 <= line.min() <= line.max() <= size[1] + 1e-6


def test_small_discs_do_not_move_the_view():
    cloud = sphere(500)
    one, other = fit_view(cloud), fit_view(cloud, radii=np.full(500, 0.02))
    assert np.array_equal(one.eye, other.eye)


@pytest.mark.parametrize("orbit", [(30, 20), (-100, 40)])
@pytest.mark.parametrize("thickness", [0.0, 0.02])
def test_a_line_that_points_at_the_eye_is_seen_whole(orbit, thickness):
    forward = fit_view(sphere(10), orbit=orbit).axes[2]
    rng = np.random.default_rng(1)
    points = np.linspace(0, 100, 101)[:, None] * forward + thickness * rng.normal(size=(101, 3))
    cloud = cloud_of(points, points)
    radii = np.full(101, 2.5)
    view = fit_view(cloud, orbit=orbit, radii=radii)
    distance = (points - view.eye) @ view.axes[2]
    widest = 2 * 2.5 * view.focal / distance.min()
    assert widest <= 0.25 * 512 * 1.001
    assert distance.max() < 10 * distance.min()
    column, line = on_image(cloud, view)
    assert 0 <= min(column.min(), line.min()) <= max(column.max(), line.max()) <= 512
