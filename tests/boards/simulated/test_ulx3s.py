"""The ULX3S's gateware as it is routed, with models of its PLLs, its pins and its SDRAM chip."""

import logging
import re

import pytest

from splatline.boards.board import Board
from splatline.boards.describe import describe
from splatline.boards.simulated import BAUD, SMALL
from splatline.boards.uart_link import UartLink
from splatline.boards.ulx3s import Ulx3s
from splatline.boards.verilog import system_files
from splatline.contract.presets import RGB24
from splatline.sim.cosim.board.board_device import ULX3S, SimulatedBoard, build_board
from splatline.sim.dvi.receiver import receive
from tests.support.board_frames import BACKGROUND, on_screen, turntable
from tests.support.faults import switched

pytestmark = pytest.mark.board

DATA_PINS = "input  wire   [15:0] sdram_dq"
"""What LiteX writes of pins that are of both directions, since the cells that drive them are the
device's; a simulator must be told."""

REFRESH = re.compile(r"^assign (\w*sdram_timer_wait) =", re.MULTILINE)
"""What lets the time to the next refresh pass."""


@pytest.fixture(scope="module")
def system():
    """Return the description of the system, and its simulator.

    But for the rate of the serial link and the video mode it is the one that is routed.
    """
    logging.disable(logging.INFO)
    soc = Ulx3s(RGB24, SMALL, BAUD)
    files = system_files(soc)
    del files["board.lpf"]
    text = files["board.v"]
    assert text.count(DATA_PINS) == 1
    text = text.replace(DATA_PINS, DATA_PINS.replace("input ", "inout "))
    (refresh,) = REFRESH.findall(text)
    files["board.v"] = switched("board", [("board", refresh, "1'd0")])(text)
    return describe(soc), build_board(files, ULX3S)


def test_its_pins_show_goldens_picture_and_the_chip_finds_no_broken_rule(tmp_path, system):
    told, built = system
    frames = turntable(1, size=(56, 40), every=400, scale=1.5)
    picture = on_screen(frames[0], (SMALL["h_active"], SMALL["v_active"]))
    with SimulatedBoard(built, tmp_path / "pins", BAUD) as simulated:
        board = Board(UartLink(simulated), told, simulated.wait)
        board.start()
        board.upload(frames, BACKGROUND)
        board.play(loop=False)
        simulated.wait(2 / board.told["refresh_hz"])
        shown = receive(simulated.watch(2.1 / board.told["refresh_hz"])).pictures
        assert len(shown) >= 1
        assert (shown == picture).all()
        assert board.counters()["underruns"] == 0
        assert simulated.command("violations") == 0


def test_a_memory_that_is_never_refreshed_is_noticed(tmp_path, system):
    told, built = system
    with SimulatedBoard(built, tmp_path / "pins", BAUD, ["+fault=1"]) as simulated:
        board = Board(UartLink(simulated), told, simulated.wait)
        board.start()  # a few milliseconds; a row is lost after 64
        assert simulated.command("violations") > 0
