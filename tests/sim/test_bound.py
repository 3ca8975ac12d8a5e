"""The fewest cycles of a frame: by hand, and beside what engines take."""

import codewords as cw
import numpy as np
import pytest
from random_frames import shapes

from splatline.host import fit_view, load_scene, make_frame, splat_radii
from splatline.host.frame import Frame, Tables
from splatline.host.order import end_word
from splatline.rtl.format import PAPER, SWIFT, WIDE
from splatline.rtl.variants import VARIANTS
from splatline.sim.bound import bound_cycles, least_cycles
from splatline.sim.cycles import count_cycles


def frame_of(rows, x, mode):
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    word = mode | scans << 1 | x << PAPER.x.lsb
    table = np.zeros((128, 3), np.int64)
    stream = np.array([word, end_word(PAPER)], np.uint64)
    return Frame(stream, Tables(np.zeros(3, np.int64), table, table), 512, 512)


@pytest.mark.parametrize(
    ("rows", "x", "mode", "expected"),
    [
        # Four lines, two words each: one cycle only where neighbouring words lie apart.
        ([(0, 7)] * 4, 4, 1, (2, 2, 1, 1)),
        # Three words in each of eight lines: three columns; 24 words in eight banks, or in sixteen.
        ([(0, 7)] * 4, 5, 0, (3, 3, 3, 2)),
        # A slanted shape: no line touches more than one word, but together they touch two.
        ([(0, 3), (0, 3), (4, 7), (4, 7)], 4, 1, (2, 1, 1, 1)),
        # A small disc across two words.
        ([(1, 0), (1, 0), (3, 4), (3, 4)], 0, 0, (2, 2, 1, 1)),
        ([(1, 0)] * 4, 1, 0, (1, 1, 1, 1)),
    ],
)
def test_known_shapes(rows, x, mode, expected):
    assert tuple(least_cycles(frame_of(rows, x, mode)).values()) == expected


ROW = [(0, 7), *cw.NOTHING[1:]]
"""Eight pixels of the line four above the engine's: one cycle and one beat, where X is even."""


def rows_at(*lines, across=64, width=512, config=WIDE):
    """A frame in which each of some lines, 4 and below, is filled with so many rows of pixels."""
    words, at = [], 0
    for line in lines:
        words.append(cw.advance(line + 4 - at))
        words += [cw.encode(ROW, x=8 * n, mode=1, config=config) for n in range(across)]
        at = line + 4
    return cw.make_frame([*words, cw.end()], (width, 512), config=config)


def test_a_line_leaves_once_it_is_drawn():
    assert bound_cycles(rows_at(9)) == 64 + 64
    assert bound_cycles(rows_at(9, config=PAPER)) == 64 * 2 + 128  # a lane has two pixels of a row


def test_lines_leave_beside_elements():
    # The first of two lines leaves while the other one is drawn.
    assert bound_cycles(rows_at(9, 10)) == 64 + 64 + 64


@pytest.mark.parametrize(("below", "waits"), [(15, 0), (16, 64)])
def test_a_line_is_drawn_into_once_the_one_in_its_place_has_left(below, waits):
    assert bound_cycles(rows_at(0, below)) == 64 + max(64, waits + 64) + 64


def test_a_window_of_fewer_lines_holds_up_more():
    low = next(config for config in VARIANTS if config.window_lines == 8)
    tall = PAPER.replace(window_lines=low.window_lines * 2, pixels_per_word=low.pixels_per_word)
    frames = [rows_at(0, 9, across=8, config=config) for config in (low, tall)]
    first, second = map(bound_cycles, frames)
    assert first > second


def test_a_frame_of_nothing_takes_nothing():
    assert bound_cycles(cw.make_frame([cw.advance(9), cw.end()], (64, 64))) == 0


@pytest.mark.parametrize("config", [PAPER, WIDE, SWIFT], ids=lambda config: config.name)
def test_no_engine_takes_fewer(config):
    scene = load_scene("knot")
    view = fit_view(scene.cloud, orbit=scene.orbit, fov=scene.fov, up=scene.up, size=(128, 96))
    radii = splat_radii(scene.cloud)
    frames = [shapes(np.random.default_rng(5), 700, 200, 90, config=config)]
    frames += [
        make_frame(scene.cloud, view, radii=scale * radii, config=config) for scale in (1, 3)
    ]
    for frame in frames:
        bound = bound_cycles(frame)
        assert 0 < bound <= count_cycles(frame, after_reset=False) < 3 * bound
