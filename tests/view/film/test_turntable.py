import numpy as np
import pytest

from splatline.view.film.turntable import fit_turntable, turntable
from tests.support.clouds import cloud_of, sphere


def stick(up):
    """A long cloud that leans."""
    along = np.linspace(-3.0, 5.0, 400)[:, np.newaxis]
    positions = along * np.roll([[0.3, 1.0, 0.1]], "xyz".index(up) - 1, axis=1)
    return cloud_of(positions, positions)


def far(cloud, camera, size):
    """Return how far out the cloud reaches, for both axes: 1 is the border."""
    view = camera.view(cloud, size)
    x, y, z = view.axes @ (cloud.positions - view.eye).T
    assert (z > view.near).all()
    across = view.focal * np.stack([x, y]) / z
    return np.abs(across).max(axis=1) * 2.0 / size


@pytest.mark.parametrize("elevation", [-35.0, 0.0, 20.0, 48.0, 75.0, 90.0])
@pytest.mark.parametrize("size", [(160, 120), (90, 150)])
@pytest.mark.parametrize("up", ["y", "z"])
def test_the_cloud_stays_in_the_picture_and_fills_it(elevation, size, up):
    for cloud in (sphere(400), stick(up)):
        camera = fit_turntable(cloud, size=size, orbit=(10.0, elevation), fov=35.0, up=up)
        reach = np.max([far(cloud, each, size) for each in turntable(camera, 72)], axis=0)
        assert reach.max() <= 1.0 / 1.06 + 1e-9
        assert reach.max() > 0.9


def test_discs_stay_in_the_picture():
    cloud = sphere(400)
    camera = fit_turntable(cloud, np.full(400, 0.4), size=(64, 64))
    assert camera.distance > fit_turntable(cloud, size=(64, 64)).distance * 1.15
    assert (camera.target == np.zeros(3)).all() or np.abs(camera.target).max() < 0.1


def test_a_turn_ends_a_step_before_it_began():
    camera = fit_turntable(sphere(100), orbit=(30.0, 20.0))
    cameras = turntable(camera, 24)
    steps = np.diff([each.azimuth for each in [*cameras, cameras[0]]]) % 360.0
    assert steps == pytest.approx(np.full(24, 15.0))
    assert {each.distance for each in cameras} == {camera.distance}
    assert cameras[0] == camera


def test_zoom_magnifies():
    cloud = sphere(200)
    usual, near = (fit_turntable(cloud, size=(64, 64), zoom=zoom) for zoom in (1.0, 2.0))
    ratio = near.view(cloud, (64, 64)).focal / usual.view(cloud, (64, 64)).focal
    assert ratio == pytest.approx(2.0)
    assert near.distance == usual.distance
