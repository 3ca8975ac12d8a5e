import pytest

from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.codeword_check import CodeWordCheck
from splatline.rtl.bus.stream_guard import StreamGuard
from tests.sim.cosim.faults.planted_campaign import PlantedCampaign

pytestmark = pytest.mark.thorough  # of what `make faults` does

FAULTS = {
    "no end is put in": (StreamGuard, "elaborate", r"\(word\.last \| cut\)", "cut"),
    "partial words are drawn": (
        *(StreamGuard, "elaborate", r"\(passing & word\.whole\)", "passing"),
    ),
    "a step is past the image too late": (
        *(CodeWordCheck, "elaborate", r"self\.last_line \+ 4", "self.last_line + 5"),
    ),
    "tables change within a frame": (
        *(AxiTop, "elaborate", r"registers\.busy\.eq\(busy\)", "registers.busy.eq(0)"),
    ),
    "counters wrap early": (
        *(AxiTop, "_count", r"counter\.eq\(counter \+ 1\)", "counter.eq((counter + 1)[:9])"),
    ),
    "an initial raster goes on after an abort": (
        *(AxiTop, "elaborate", r"initial\.cut\.eq\(aborting", "initial.cut.eq(0 & aborting"),
    ),
}


@pytest.fixture(scope="module")
def campaign():
    return PlantedCampaign(list(FAULTS.values()), "axi")


def test_a_sample_of_every_kind_is_right(campaign):
    tally = campaign.sample(0, to_the_end=True)
    assert tally.wrong == []


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_noticed(campaign, name):
    kinds = ["packets", "accesses of the bus", "aborts", "counters"]
    assert campaign.sample(1 + list(FAULTS).index(name), kinds).wrong
