import pytest

from splatline.host.quality import QUALITIES
from splatline.sim.stress import measure
from splatline.sim.stress_themes import themes

CASES = themes()["sizes"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_splat_of_any_size_covers_what_it_should(case, quality):
    assert measure(case, quality).problems == ()
