import pytest

from splatline.host.encode.quality import QUALITIES
from splatline.sim.stress.case import draw, measure
from splatline.sim.stress.themes import themes

THEMES = themes()


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", THEMES["camera"].cases, ids=lambda case: case.name)
def test_points_about_the_eye_neither_break_nor_flood_the_stream(case, quality):
    assert measure(case, quality).problems == ()


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", THEMES["fov"].cases, ids=lambda case: case.name)
def test_every_field_of_view_is_as_near_to_the_truth(case, quality):
    assert measure(case, quality).problems == ()


@pytest.mark.parametrize("quality", QUALITIES)
def test_a_disc_far_beyond_every_integer_takes_no_time(quality):
    # Centre at column 1e29, radius 5e30 pixels: neither fits an integer.
    name = "a point 1e-30 in front of the eye, 0.001 aside, radius 0.05"
    scene = next(case for case in THEMES["camera"].cases if case.name == name).make()
    seconds = [draw(scene, quality)[0].counts["seconds"]["encode"] for _ in range(3)]
    assert min(seconds) < 0.5
