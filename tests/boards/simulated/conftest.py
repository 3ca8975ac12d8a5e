"""A simulated board for the tests of this folder, built once."""

import logging

import pytest

from tests.support.board_frames import on_screen, turntable
from tests.support.faults import switched

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

SHOWN = "soc_scanout_scanout1"
"""The buffer that is shown."""

OTHER = f"({SHOWN} ? {{0}}_0_storage - {{0}}_1_storage : {{0}}_1_storage - {{0}}_0_storage)".format(
    "soc_scanout_buffer"
)
"""Bytes from the shown buffer to the other one."""

PIXEL = "soc_scanout_crossing_source_source_payload_data"

FAULTS = {
    "another picture in mid-scan": (
        *("board", "soc_scanout_dma_sink_sink_payload_address"),
        f"((soc_scanout_scanout2 + (soc_enginecore_swap_valid ? {OTHER} : 32'd0)) >> 2)"
        " + soc_scanout_scanout3",
    ),
    "red and green are swapped": (
        *("board", "soc_scanout_compositor_pixels_payload_data"),
        f"{{{PIXEL}[31:16], {PIXEL}[7:0], {PIXEL}[15:8]}}",
    ),
    "a late pixel moves the others": ("board", "soc_scanout_compositor_missing", "1'd0"),
    "late pixels of the refresh before are shown": (
        *("board", "soc_scanout_crossing_sink_sink_valid"),
        "soc_scanout_dma_source_source_valid",
    ),
}
"""Faults of the gateware: module, signal, and what it is instead; ``+fault=N`` plants the Nth.

Migen names signals after variables of the functions that make them, such as ``soc`` below."""


@pytest.fixture(scope="session")
def system():
    """Return the description of a small system, and its Verilog with the faults."""
    logging.disable(logging.INFO)  # LiteX tells much
    soc = SimulatedSoC(RGB24, SMALL, refreshes=REFRESHES)
    files = system_files(soc)
    del files["board.lpf"]
    files["board.v"] = switched("board", FAULTS.values())(files["board.v"])
    return describe(soc), files


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
