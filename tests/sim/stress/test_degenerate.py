import numpy as np
import pytest

from splatline import host
from splatline.host.encode.quality import QUALITIES
from splatline.sim import golden
from splatline.sim.stress.case import measure
from splatline.sim.stress.themes import themes

CASES = themes()["degenerate"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_cloud_without_extent_is_drawn_where_it_is(case, quality):
    assert measure(case, quality).problems == ()


def draw_two_points(distance, quality):
    positions = np.array([[0.0, 0.0, 0.0], [distance, 0.0, 0.0]])
    cloud = host.assemble_cloud(host.Columns(positions), "two")
    view = host.fit_view(cloud, size=(96, 80))
    return golden.render(
        host.make_frame(cloud, view, radii=host.splat_radii(cloud), quality=quality)
    )


@pytest.mark.parametrize("quality", QUALITIES)
def test_two_points_look_the_same_however_close(quality):
    # Their squares are zero in any float, which the reference of the suite could not draw either.
    near, apart = draw_two_points(2.0**-1000, quality), draw_two_points(1.0, quality)
    assert near.mismatches(apart) == 0


@pytest.mark.parametrize("quality", QUALITIES)
def test_coordinates_without_precision_are_drawn_within_the_image(quality):
    # At the smallest subnormal a quotient is rounded to whole steps: no shape can be asked for.
    assert draw_two_points(5e-324, quality).drawn.any()
