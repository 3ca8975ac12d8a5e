import re

import pytest

from splatline.contract.presets import PAPER
from splatline.rtl.engine import Engine
from splatline.rtl.front.sequencer import Sequencer
from splatline.rtl.tiles.window import TileWindow
from splatline.rtl.window.loader import Loader
from splatline.sim.cosim.faults.upset_trials import OUTCOMES
from tests.sim.cosim.faults.planted_campaign import PlantedCampaign

OPEN = [
    (Engine, "elaborate", re.escape(name) + r"\.eq\(", r"\g<0>1 | ")
    for name in ("tables.idle", "sequencer.admit")
]
"""Table writes within a frame, a frame before its tables."""

pytestmark = pytest.mark.thorough  # of what `make faults` does

FAULTS = {
    "table writes are taken within a frame": OPEN[0],
    "a frame opens before its tables": OPEN[1],
    "the line is wrong after a frame": (Sequencer, "elaborate", r"Mux\(end, -4,", "Mux(end, -3,"),
    "the line wraps": (Sequencer, "elaborate", r"Mux\(overflow, lowest, advanced\)", "advanced"),
    "beats below the image are loaded": (
        *(Loader, "elaborate", r"\| \(beat\.line > self\.last_line\)", ""),
    ),
    "beats above the last line are loaded": (
        *(Loader, "elaborate", r"\| \(beat\.line < self\.limit\)", ""),
    ),
    "the window is not cleared after a reset": (
        *(TileWindow, "_clear", r"sweeping\.eq\(~sweep\.all\(\)\)", "sweeping.eq(0)"),
    ),
}


NOTICED_BY = {
    "the line is wrong after a frame": ["stalls"],
    "the line wraps": ["words of any bits"],
    "beats below the image are loaded": ["initial rasters"],
    "beats above the last line are loaded": ["initial rasters"],
    "the window is not cleared after a reset": ["resets"],
}
"""The kind of trials that must notice a fault, if it is not table writes."""


@pytest.fixture(scope="module")
def campaign():
    return PlantedCampaign(list(FAULTS.values()))


def test_a_sample_of_every_kind_is_right(campaign):
    tally = campaign.sample(0, to_the_end=True)
    assert tally.wrong == []
    assert tally.trials >= 300
    assert tally.frames > tally.trials
    assert tally.silence <= PAPER.clear_cycles + 48 + 64
    assert 0.5 < tally.nearest <= 1


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_noticed(campaign, name):
    kinds = NOTICED_BY.get(name, ["table writes"])
    assert campaign.sample(1 + list(FAULTS).index(name), kinds).wrong


def test_the_same_numbers_are_the_same_trials(campaign):
    one, other = (campaign.campaign.play("streams", range(20, 40), 60) for _ in range(2))
    assert one == other


def test_upsets_are_counted_by_module(campaign):
    tally = campaign.campaign.play("upsets", range(120), 120)
    assert tally.outcomes.total() == 120
    assert {outcome for *_, outcome in tally.outcomes} <= set(OUTCOMES)
    assert {where for _, where, _ in tally.outcomes} == {"register", "memory"}
    right = sum(n for (*_, outcome), n in tally.outcomes.items() if outcome == "right")
    assert 40 < right < 120
