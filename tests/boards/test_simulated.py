"""A simulated board has the memory, the clock and the link of the real one."""

import logging

import pytest

from splatline.contract.presets import RGB24

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards.catalog import make_system
from splatline.boards.simulated import SMALL, SimulatedSoC

SIMULATED = {"ulx3s": "ulx3s", "colorlight-i5": "colorlight", "colorlight-i9": "colorlight"}


def values(settings):
    """Return LiteDRAM's settings as a dictionary, without their reference to themselves."""
    return {name: value for name, value in vars(settings).items() if name != "self"}


@pytest.mark.parametrize("name", SIMULATED)
def test_memory_and_clock_are_the_board_s(name):
    logging.disable(logging.INFO)
    board = make_system(name, RGB24)
    simulated = SimulatedSoC(RGB24, SMALL, board=SIMULATED[name])
    assert simulated.sys_clk_freq == board.sys_clk_freq
    assert values(simulated.sdrphy.settings) == values(board.sdrphy.settings)
    ours, theirs = (soc.sdram.controller.settings for soc in (simulated, board))
    assert values(ours.geom) == values(theirs.geom)
    assert values(ours.timing) == values(theirs.timing)
    assert hasattr(simulated, "ethernet") == hasattr(board, "ethernet")
