import pytest

from splatline.host.encode.quality import QUALITIES
from splatline.sim.stress.case import measure
from splatline.sim.stress.themes import themes

CASES = themes()["sizes"].cases


@pytest.mark.parametrize("quality", QUALITIES)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_splat_of_any_size_covers_what_it_should(case, quality):
    assert measure(case, quality).problems == ()
