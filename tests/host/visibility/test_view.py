import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.visibility.view import fit_view
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
        ({"fov": 0.0}, "between 0 and 180"),
        ({"fov": float("nan")}, "between 0 and 180"),
        ({"size": (0, 5)}, "at least one pixel"),
        ({"up": "w"}, "x, y, z"),
        ({"zoom": 0.0}, "zoom"),
        ({"orbit": (float("inf"), 0.0)}, "orbit"),
    ],
)
def test_bad_parameters_are_named(options, message):
    with pytest.raises(InputError, match=message):
        fit_view(sphere(10), **options)
