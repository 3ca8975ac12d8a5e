"""Planted faults of a board's gateware: the checks of its pins must notice each of them."""

import pytest

from tests.boards.simulated.conftest import FAULTS
from tests.support.board_frames import BACKGROUND
from tests.support.board_screen import BIT, cut_off, seconds, watch, which

pytestmark = pytest.mark.board

NUMBERS = {name: number for number, name in enumerate(FAULTS, 1)}
STARVED = {"a late pixel moves the others", "late pixels of the refresh before are shown"}
"""Those that need a screen without enough memory."""


@pytest.mark.parametrize("name", [name for name in FAULTS if name not in STARVED])
def test_a_refresh_is_no_picture_of_golden(start, frames, pictures, name):
    simulated, board = start(bit=BIT, fault=NUMBERS[name])
    board.upload(frames, BACKGROUND)
    board.play()
    simulated.wait(seconds(2))
    assert -1 in which(watch(simulated, 3), pictures)


@pytest.mark.parametrize("name", sorted(STARVED))
def test_a_starved_screen_shows_old_pixels(start, frames, pictures, name):
    simulated, board = start(fault=NUMBERS[name])
    board.upload(frames, BACKGROUND)
    board.play()
    simulated.wait(seconds(2, bit=4))
    board.set("traffic_enable", 3)
    simulated.wait(seconds(1, bit=4))
    assert not all(cut_off(refresh, pictures) for refresh in watch(simulated, 3, bit=4))
