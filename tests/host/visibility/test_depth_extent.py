"""The depth range of an engine with planes holds every disc's rim."""

import numpy as np
import pytest

from splatline.contract.presets import PLANE
from splatline.host.pipeline import make_frame
from splatline.host.visibility.depth_extent import depth_extent
from splatline.host.visibility.splats import SPLAT, Splats
from splatline.host.visibility.view import View
from splatline.sim import golden
from tests.support.clouds import cloud_of

FOCAL = 100.0
VIEW = View(np.zeros(3), np.eye(3), FOCAL, 64, 48, 0.01)


def splats_of(*discs):
    data = np.zeros(len(discs), SPLAT)
    for name, values in zip(
        ("depth", "diameter", "slope_x", "slope_y"), zip(*discs, strict=True), strict=True
    ):
        data[name] = values
    return Splats.of(data)


def test_the_range_reaches_from_rim_to_rim():
    # 3 + 1/2 pixels of 2 / 100 each, of which slopes (3, 4) take 5 / sqrt(26).
    reach = 3.5 * 0.02 * 5 / np.sqrt(26)
    low, high = depth_extent(splats_of((2.0, 6.0, 3.0, 4.0)), VIEW, 4094)
    assert low == pytest.approx(2.0 - reach)
    assert high == pytest.approx(2.0 + reach + 2 * reach * 2 / 4094)
    low, high = depth_extent(splats_of((2.0, 6.0, 0.0, 0.0), (3.0, 9.0, 0.0, 0.0)), VIEW, 100)
    assert (low, high) == (2.0, pytest.approx(3.02))


@pytest.mark.parametrize("slope", (1e18, np.inf))
def test_a_disc_on_edge_reaches_its_radius_and_the_near_distance_at_most(slope):
    low, high = depth_extent(splats_of((2.0, 6.0, slope, 0.0)), VIEW, 4094)
    assert low == pytest.approx(1.93)
    assert high == pytest.approx(2.07, rel=1e-4)
    assert depth_extent(splats_of((2.0, 600.0, slope, 0.0)), VIEW, 4094)[0] == VIEW.near


def test_no_splat_has_no_range():
    assert depth_extent(Splats.of(np.zeros(0, SPLAT)), VIEW, 4094) == (0.0, 0.0)


def test_the_rim_of_the_furthest_disc_is_drawn():
    """Two slanted discs: half of the further one lies behind its centre."""
    points = np.array([[-0.5, 0.0, 4.0], [0.5, 0.0, 5.0]])
    normals = np.array([[0.9, 0.0, -np.sqrt(1 - 0.81)]] * 2)
    cloud = cloud_of(points, normals)
    frame = make_frame(cloud, VIEW, radii=np.array([0.2, 0.2]), config=PLANE)
    drawn = golden.render(frame).drawn
    behind = make_frame(
        cloud, VIEW, radii=np.array([0.2, 0.2]), config=PLANE, depth_range=(3.0, 9.0)
    )
    np.testing.assert_array_equal(drawn, golden.render(behind).drawn)
    clipped = make_frame(
        cloud, VIEW, radii=np.array([0.2, 0.2]), config=PLANE, depth_range=(3.0, 5.0)
    )
    left = golden.render(clipped).drawn
    assert 0.4 < left[:, 32:].sum() / drawn[:, 32:].sum() < 0.7
    np.testing.assert_array_equal(left[:, :32], drawn[:, :32])
