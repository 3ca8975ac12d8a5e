import pytest

from splatline.host.quality import QUALITIES
from splatline.sim.stress import measure
from splatline.sim.stress_themes import themes

CASES = themes()["degenerate"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_cloud_without_extent_is_drawn_where_it_is(case, quality):
    assert measure(case, quality).problems == ()
