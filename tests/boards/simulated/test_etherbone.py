"""A board with Etherbone in Verilator: from the pins of RGMII to those of HDMI."""

import logging

import numpy as np
import pytest

from splatline.boards.board import Board
from splatline.boards.colorlight import ADDRESS, PORT
from splatline.boards.describe import describe
from splatline.boards.etherbone_link import EtherboneLink
from splatline.boards.link import LinkError
from splatline.boards.simulated import SMALL, SimulatedSoC
from splatline.boards.verilog import system_files
from splatline.contract.presets import RGB24
from splatline.sim.cosim.board.board_device import RGMII, SimulatedBoard, build_board
from splatline.sim.cosim.board.network import BoardNetwork
from tests.support.board_frames import BACKGROUND
from tests.support.board_screen import BIT, seconds, watch, which

pytestmark = pytest.mark.board

HEAD = bytes([0x4E, 0x6F, 0x10, 0x44, 0, 0, 0, 0])
"""Etherbone's magic number, version and sizes."""

HALF = 500
"""Bytes of a frame that leave before the cable is pulled out."""


def written(address, words):
    """Return a packet that writes words."""
    record = bytes([0, 15, len(words), 0]) + address.to_bytes(4, "big")
    return HEAD + record + words.astype(">u4").tobytes()


@pytest.fixture(scope="module")
def system():
    logging.disable(logging.INFO)
    soc = SimulatedSoC(RGB24, SMALL, board="colorlight")
    files = system_files(soc)
    del files["board.lpf"]
    return describe(soc), build_board(files, options=RGMII)


@pytest.fixture
def network(system, tmp_path):
    half = 0.5e9 / system[0]["clk_freq"]  # ns
    plusargs = [f"+bit={BIT}", f"+sys_half={half:.3f}"]
    with SimulatedBoard(system[1], tmp_path / "pins", plusargs=plusargs) as simulated:
        yield BoardNetwork(simulated, ADDRESS)


@pytest.fixture
def board(system, network):
    made = Board(EtherboneLink(ADDRESS, PORT, network), system[0], network.board.wait)
    made.start()
    return made


def test_a_turntable_comes_in_at_rgmii_and_its_pictures_go_out_at_hdmi(
    network, board, frames, pictures
):
    board.upload(frames, BACKGROUND)
    board.play()
    network.board.wait(seconds(2))
    shown = which(watch(network.board, 4), pictures)
    assert shown == [(shown[0] + n) % 3 for n in range(4)]
    assert shown[0] >= 0
    counters = board.counters()
    assert (counters["underruns"], counters["writer_error"]) == (0, 0)


def test_a_cable_that_is_pulled_out_leaves_the_last_whole_picture(network, board, frames, pictures):
    board.upload(frames[:1], BACKGROUND)
    board.play(loop=False)
    network.board.wait(seconds(1))
    # The first half of a frame of code words, and then nothing. Etherbone waits for the other half.
    place = board.told["main_ram"] + 2 * 4 * 104 * 88
    network.sendto(written(place, np.zeros(240, np.uint32)), (ADDRESS, PORT), HALF)
    assert which(watch(network.board, 1), pictures) == [0]
    with pytest.raises(LinkError, match="does not answer"):
        board.counters()
    # After a reset the board is as new.
    network.board.reset()
    board.start()
    board.upload(frames[1:2], BACKGROUND)
    board.play(loop=False)
    network.board.wait(seconds(1))
    assert which(watch(network.board, 1), pictures) == [1]


def test_bursts_of_every_length_come_back(board):
    base = board.told["main_ram"] + 0x10_0000
    random = np.random.default_rng(2)
    for count in (1, 2, 3, 7, 8, 9, 61, 239, 240, 241, 700):
        words = random.integers(1 << 32, size=count, dtype=np.uint32)
        board.link.write(base, words)
        assert (board.link.read(base, count) == words).all()
