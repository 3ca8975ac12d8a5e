"""The camera on its orbit."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.host.cloud.cloud import Cloud
from splatline.host.visibility.view import UP_AXES, fit_view
from splatline.view.camera import Camera, fit_camera

SIZE = (320, 200)


def cloud_at(origin, count=50):
    """Return a few points about an origin."""
    positions = np.random.default_rng(3).normal(size=(count, 3))
    none = np.zeros((count, 3), np.float32)
    two_sided = np.ones(count, np.bool_)
    return Cloud(positions, none, none.astype(np.uint8), two_sided, np.asarray(origin), "few", {})


CAMERAS = st.builds(
    Camera,
    st.tuples(*(st.floats(-1e3, 1e3) for _ in range(3))),
    st.floats(0.5, 1e3),
    st.floats(-180.0, 180.0),
    st.floats(-90.0, 90.0),
    st.sampled_from(list(UP_AXES)),
    st.floats(5.0, 120.0),
)


def project(camera, point, size=SIZE):
    """Return column, line and depth of a point in the file's coordinates."""
    view = camera.view(cloud_at((0.0, 0.0, 0.0)), size)
    x, y, z = view.axes @ (np.asarray(point) - view.eye)
    return view.middle[0] + view.focal * x / z, view.middle[1] + view.focal * y / z, z


@given(CAMERAS, st.floats(0, SIZE[0]), st.floats(0, SIZE[1]), st.floats(0.1, 1e3))
def test_the_point_at_a_pixel_is_seen_at_that_pixel(camera, column, line, depth):
    point = camera.point_at((column, line), depth, SIZE)
    seen = project(camera, point)
    scale = max(1.0, *map(abs, camera.target), camera.distance) / depth
    assert seen[:2] == pytest.approx((column, line), abs=1e-8 * (1.0 + 1e3 * scale))
    assert seen[2] == pytest.approx(depth, abs=1e-9 * (depth + 1e4))


@given(CAMERAS, st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_a_pan_moves_the_target_s_plane_with_the_hand(camera, right, down):
    moved = camera.panned(right, down, SIZE)
    column, line, depth = project(moved, camera.target)
    assert (column, line) == pytest.approx((SIZE[0] / 2 + right, SIZE[1] / 2 + down), abs=1e-4)
    assert depth == pytest.approx(camera.distance, rel=1e-6)


@given(CAMERAS, st.floats(0.1, 10.0), st.floats(0, SIZE[0]), st.floats(0, SIZE[1]))
def test_a_zoom_keeps_what_is_under_the_cursor(camera, factor, column, line):
    point = camera.point_at((column, line), camera.distance, SIZE)
    zoomed = camera.zoomed(factor, (column, line), SIZE)
    assert zoomed.distance == pytest.approx(factor * camera.distance)
    assert project(zoomed, point)[:2] == pytest.approx((column, line), abs=1e-3)


def test_a_turn_stops_over_the_top_and_goes_round():
    camera = Camera((0.0, 0.0, 0.0), 1.0, 170.0, 80.0)
    turned = camera.turned(20.0, 15.0)
    assert (turned.azimuth, turned.elevation) == (-170.0, 90.0)
    assert turned.turned(0.0, -200.0).elevation == -90.0


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (5e5, 5.4e6, -120.0)])
def test_the_fitted_camera_sees_what_fit_view_sees(origin):
    cloud = cloud_at(origin)
    options = {"orbit": (-40.0, 12.5), "fov": 28.0, "up": "z"}
    fitted = fit_view(cloud, size=SIZE, **options)
    camera = fit_camera(cloud, size=SIZE, **options)
    seen = camera.view(cloud, SIZE)
    assert seen.eye == pytest.approx(fitted.eye, abs=1e-6)
    assert np.array_equal(seen.axes, fitted.axes)
    assert seen.focal == fitted.focal


def test_rounding_keeps_few_digits_also_far_from_the_origin():
    camera = Camera((512345.678901234, 5403210.987654321, -0.00000012), 8.123456789012, 12.3456)
    rounded = camera.rounded()
    assert rounded.target == (512345.678901, 5403210.987654, 0.0)
    assert rounded.distance == 8.12345679
    assert (rounded.azimuth, rounded.elevation) == (12.35, 20.0)
    assert str(rounded.target[2]) == "0.0"
    near = dataclasses.replace(camera, distance=8.1e-5)
    assert near.rounded().target[0] == pytest.approx(camera.target[0], abs=1e-9)
