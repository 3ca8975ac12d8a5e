"""The driver of a board, on a bus that is a dictionary."""

import dataclasses

import numpy as np
import pytest

from splatline.boards.board import Board
from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER, RGB24
from tests.support.fake_bus import DESCRIPTION, FakeBus
from tests.support.random_frames import frame_of, word


def frame(width=100, height=90, words=5, config=RGB24):
    rows = [(0, 3)] * 4
    return frame_of([word(rows, n, 7, config=config) for n in range(words)], width, height,
                    config=config)  # fmt: skip


@pytest.fixture
def board():
    made = Board(FakeBus(), DESCRIPTION, lambda seconds: None)
    made.start()
    return made


def test_frames_lie_behind_the_buffers_and_their_places_are_in_the_list(board):
    frames = [frame(words=5), frame(words=9)]
    board.upload(frames, (1, 2, 3))
    words = board.link.words
    base, begin = DESCRIPTION["main_ram"], 2 * 36864
    listed = [words[DESCRIPTION["frame_list"] + 4 * n] for n in range(4)]
    assert listed == [begin, 12, begin + 48, 20]
    for at, sent in ((begin, frames[0]), (begin + 48, frames[1])):
        got = [words[base + at + 4 * n] for n in range(2 * len(sent.codewords))]
        assert got == sent.codewords.view(np.uint32).tolist()
    assert board.link.value("player_frames") == 2
    assert board.link.value("scanout_background") == 0x030201
    assert board.link.value("scanout_enable") == 1


@pytest.mark.parametrize(
    ("size", "place"),
    [
        ((100, 90), {"left": 30, "top": 15, "columns": 100, "lines": 90, "offset": 0}),
        ((200, 90), {"left": 0, "top": 15, "columns": 160, "lines": 90, "offset": 80}),
        ((100, 130), {"left": 30, "top": 0, "columns": 100, "lines": 120, "offset": 2000}),
    ],
)
def test_a_picture_is_in_the_middle_and_cut_off_evenly(board, size, place):
    board.upload([frame(*size)])
    assert {name: board.link.value(f"scanout_{name}") for name in place} == place
    assert board.link.value("scanout_stride") == 4 * size[0]


def test_frames_that_do_not_fit_are_refused_in_one_line(board):
    one = frame()
    tables = dataclasses.replace(one.tables, ambient=one.tables.ambient + 1)
    for frames, said in (
        ([], "no frame"),
        ([one] * 5, "holds 4 frames"),
        ([one, frame(width=99)], "frame 2 has another size"),
        ([one, dataclasses.replace(one, tables=tables)], "frame 2 has other tables"),
        ([frame(config=PAPER)], "preset paper"),
        ([frame(words=140_000)], "has room for"),
    ):
        with pytest.raises(InputError, match=said):
            board.upload(frames)


def test_a_board_without_engine_memory_or_answer_is_said():
    bus = FakeBus()
    bus.words[DESCRIPTION["engine"]] = 0
    with pytest.raises(InputError, match="no Splatline engine"):
        Board(bus, DESCRIPTION, lambda seconds: None).start()
    with pytest.raises(InputError, match="has preset paper"):
        Board(FakeBus(PAPER), DESCRIPTION, lambda seconds: None).start()

    class Leaky(FakeBus):
        def write(self, address, words):
            if address != DESCRIPTION["main_ram"] + 64:
                super().write(address, words)

    with pytest.raises(InputError, match="SDRAM does not keep what is written at 0x40"):
        Board(Leaky(), DESCRIPTION, lambda seconds: None).start()

    class Deaf(FakeBus):
        def read(self, address, count=1):
            return np.zeros(count, np.uint32)

    with pytest.raises(InputError, match="scratch"):
        Board(Deaf(), DESCRIPTION, lambda seconds: None).start()


def test_a_frame_that_does_not_end_is_said(board):
    board.link.words[DESCRIPTION["registers"]["player_busy"]] = 1
    with pytest.raises(InputError, match="does not end"):
        board.stop()


def test_play_sets_the_players_registers(board):
    board.upload([frame()])
    board.play(loop=True, hold=3)
    names = ("player_enable", "player_loop", "player_hold")
    assert [board.link.value(name) for name in names] == [1, 1, 3]
    assert set(board.counters()) == {"refreshes", "swaps", "underruns", "played", "writer_error"}
