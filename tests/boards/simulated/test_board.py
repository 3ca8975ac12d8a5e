"""A whole board in Verilator: from the pins of the serial link to those of HDMI."""

import pytest

from splatline.boards.simulated import SMALL
from splatline.sim.dvi.receiver import receive
from tests.support.board_frames import BACKGROUND
from tests.support.board_screen import BIT, CHARACTERS, cut_off, seconds, watch, which

pytestmark = pytest.mark.board


def test_every_refresh_is_a_picture_of_golden(start, frames, pictures):
    simulated, board = start(bit=BIT)
    board.upload(frames, BACKGROUND)
    board.play()
    simulated.wait(seconds(2))
    pins = simulated.watch(seconds(7))
    screen = receive(pins)
    assert screen.characters == CHARACTERS
    assert len(screen.pictures) >= 6
    assert screen.pictures.shape[1:] == (SMALL["v_active"], SMALL["h_active"], 3)
    shown = which(screen.pictures, pictures)
    assert shown == [(shown[0] + n) % 3 for n in range(len(shown))]  # a frame a refresh, in turn
    assert shown[0] >= 0
    counters = board.counters()
    assert (counters["underruns"], counters["writer_error"]) == (0, 0)
    assert board.engine.errors() == []
    # A wrong bit of one pixel would be seen, and a channel whose bits are inverted. Its control
    # characters are control characters still.
    screen.pictures[2, 40, 30, 1] ^= 1
    assert which(screen.pictures, pictures)[2] == -1
    assert set(which(receive(pins ^ 2).pictures, pictures)) == {-1}
    board.stop()
    still = which(watch(simulated, 3), pictures)
    assert -1 not in still
    assert still[1] == still[2]


def test_a_link_that_stops_leaves_the_last_whole_picture(start, frames, pictures):
    simulated, board = start(bit=BIT)
    board.upload(frames[:1], BACKGROUND)
    board.play(loop=False)
    simulated.wait(seconds(1))
    # The first half of a burst into the code words, and then nothing.
    address = (board.told["main_ram"] + 2 * 4 * 104 * 88) // 4
    simulated.write(bytes([1, 255]) + address.to_bytes(4, "big") + bytes(501))
    assert which(watch(simulated, 2), pictures) == [0, 0]
    # A reset in the middle of the burst, of a line and of a refresh; then a start as the first.
    simulated.reset()
    assert (watch(simulated, 1) == 0).all()
    board.start()
    board.upload(frames[1:2], BACKGROUND)
    board.play(loop=False)
    simulated.wait(seconds(1))
    assert which(watch(simulated, 1), pictures) == [1]


def test_reads_of_other_rows_take_nothing_from_the_screen(start, frames, pictures):
    """Four masters read all the time, each from another row each time."""
    simulated, board = start()
    board.upload(frames, BACKGROUND)
    board.play()
    board.set("traffic_enable", 1)
    simulated.wait(seconds(2, bit=4))
    assert -1 not in which(watch(simulated, 4, bit=4), pictures)
    assert board.counters()["underruns"] == 0


def test_a_starved_screen_is_whole_again_afterwards(start, frames, pictures):
    """Four masters take row after row from the screen."""
    simulated, board = start()
    board.upload(frames, BACKGROUND)
    board.play()
    simulated.wait(seconds(2, bit=4))
    assert board.counters()["underruns"] == 0
    board.set("traffic_enable", 3)
    simulated.wait(seconds(1, bit=4))
    starved = watch(simulated, 4, bit=4)
    assert board.counters()["underruns"] >= 4
    assert -1 in which(starved, pictures)
    assert all(cut_off(refresh, pictures) for refresh in starved)
    board.set("traffic_enable", 0)
    simulated.wait(seconds(1, bit=4))
    before = board.counters()["underruns"]
    shown = which(watch(simulated, 3, bit=4), pictures)
    assert -1 not in shown
    assert board.counters()["underruns"] == before
