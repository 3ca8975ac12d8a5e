"""A simulated board for the tests of this folder, built once."""

import logging

import pytest

from tests.support.board_frames import on_screen, turntable

pytest.importorskip("litex", reason="pip install '.[board-test]'")

from splatline.boards.board import Board
from splatline.boards.describe import describe
from splatline.boards.simulated import BAUD, SMALL, SimulatedSoC
from splatline.boards.uart_link import UartLink
from splatline.boards.verilog import system_files
from splatline.contract.presets import RGB24
from splatline.sim.cosim.board.board_device import SimulatedBoard, build_board

REFRESHES = 3
"""Refreshes of the SDRAM for each one that is needed."""


@pytest.fixture(scope="session")
def system():
    """Return the description of a small system, and its Verilog."""
    logging.disable(logging.INFO)  # LiteX tells much
    soc = SimulatedSoC(RGB24, SMALL, refreshes=REFRESHES)
    files = system_files(soc, RGB24)
    return describe(soc), {name: text for name, text in files.items() if not name.endswith(".lpf")}


@pytest.fixture
def start(system, tmp_path):
    """Return a function that starts a board and its simulator; they end with the test."""
    told, files = system
    built = build_board(files)
    running = []

    def start_board(**plusargs):
        words = [f"+{name}={value}" for name, value in plusargs.items()]
        simulated = SimulatedBoard(built, tmp_path / "pins", BAUD, words)
        running.append(simulated)
        board = Board(UartLink(simulated), told, simulated.wait)
        board.start()
        return simulated, board

    yield start_board
    for simulated in running:
        simulated.close()


@pytest.fixture(scope="session")
def frames():
    """Return a turntable of three pictures, of which the engine draws each in a refresh."""
    return turntable(3, size=(104, 88), every=60, scale=1.2)


@pytest.fixture(scope="session")
def pictures(frames):
    """Return what the screen must show of each frame."""
    return [on_screen(frame, (SMALL["h_active"], SMALL["v_active"])) for frame in frames]
