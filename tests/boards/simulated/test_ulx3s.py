"""The ULX3S's gateware as it is routed, with models of its PLLs, its pins and its SDRAM chip."""

import logging
import os

import pytest

from splatline.boards.board import Board
from splatline.boards.catalog import BAUD
from splatline.boards.describe import describe
from splatline.boards.simulated import SMALL
from splatline.boards.uart_link import UartLink
from splatline.boards.ulx3s import Ulx3s
from splatline.boards.verilog import system_files
from splatline.contract.presets import RGB24
from splatline.sim.cosim.board.board_device import ULX3S, SimulatedBoard, build_board
from splatline.sim.dvi.receiver import receive
from tests.support.board_frames import BACKGROUND

pytestmark = [
    pytest.mark.board,
    pytest.mark.skipif(
        "SPLATLINE_CHIPS" not in os.environ,
        reason="takes minutes of processor time: SPLATLINE_CHIPS=1 make test-board",
    ),
]

DATA_PINS = "input  wire   [15:0] sdram_dq"
"""What LiteX writes of pins that are of both directions, since the cells that drive them are the
device's; a simulator must be told."""


def test_its_pins_show_goldens_picture_and_the_chip_finds_no_broken_rule(
    tmp_path, frames, pictures
):
    logging.disable(logging.INFO)
    soc = Ulx3s(RGB24, SMALL)
    files = system_files(soc, RGB24)
    files.pop("board.lpf")
    assert files["board.v"].count(DATA_PINS) == 1
    files["board.v"] = files["board.v"].replace(DATA_PINS, DATA_PINS.replace("input ", "inout "))
    with SimulatedBoard(build_board(files, ULX3S), tmp_path / "pins", BAUD) as simulated:
        board = Board(UartLink(simulated), describe(soc), simulated.wait)
        board.start()
        board.upload(frames[:1], BACKGROUND)
        board.play(loop=False)
        simulated.wait(2 / board.told["refresh_hz"])
        shown = receive(simulated.watch(2.1 / board.told["refresh_hz"])).pictures
        assert len(shown) >= 1
        assert (shown == pictures[0]).all()
        assert board.counters()["underruns"] == 0
        assert simulated.command("violations") == 0
