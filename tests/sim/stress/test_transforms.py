import pytest

from splatline.host.encode.quality import QUALITIES
from splatline.sim.stress.case import measure
from splatline.sim.stress.themes import themes

CASES = themes()["transforms"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_moved_or_scaled_cloud_is_the_same_picture(case, quality):
    assert measure(case, quality).problems == ()
