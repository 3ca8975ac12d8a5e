"""The fewest cycles of a frame: by hand, and beside what engines take."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER, PLANE, PRESETS, SWIFT
from splatline.contract.variants import SHAPED, VARIANTS
from splatline.host.encode.sort_by_line import advance_word, end_word
from splatline.sim.cycles.bound import bound_cycles
from splatline.sim.cycles.cycles import count_cycles
from splatline.sim.cycles.front import halves_of
from splatline.sim.cycles.tiles import least_lane_cycles
from tests.support import codewords as cw
from tests.support import plane_words as pw
from tests.support import random_frames
from tests.support.random_frames import nonsense, shapes, word
from tests.support.scene_frames import scene_frame


def frame_of(rows, x, mode):
    scans = sum((first | last << 3) << 6 * row for row, (first, last) in enumerate(rows))
    word = mode | scans << 1 | x << PAPER.x.lsb
    table = np.zeros((128, 3), np.int64)
    stream = np.array([word, end_word(PAPER)], np.uint64)
    return Frame(stream, Tables(np.zeros(3, np.int64), table, table), 512, 512)


@pytest.mark.parametrize(
    ("rows", "x", "mode", "expected"),
    [
        # Four lines of eight pixels; of lanes there are 2, 4 and 8 a line.
        ([(0, 7)] * 4, 4, 1, (4, 2, 1)),
        # Eight lines of them, two on each row of lanes.
        ([(0, 7)] * 4, 5, 0, (8, 4, 2)),
        # A slanted shape: four pixels a line.
        ([(0, 3), (0, 3), (4, 7), (4, 7)], 4, 1, (2, 1, 1)),
        # A small disc, in lanes of its own wherever it lies.
        ([(1, 0), (1, 0), (3, 4), (3, 4)], 0, 0, (1, 1, 1)),
        ([(1, 0)] * 4, 1, 0, (1, 1, 1)),
    ],
)
def test_known_shapes(rows, x, mode, expected):
    halves = halves_of(frame_of(rows, x, mode).codewords[:1], PAPER)
    assert tuple(int(least_lane_cycles(*halves, pixels)[0]) for pixels in (2, 4, 8)) == expected


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        # The half turn lies in columns 4..7: of the other tiles, in the same lanes.
        ({}, (4, 2, 1)),
        # One end moved outwards, to column 3: three tiles.
        ({"sides": 0x55, "first_out": 1}, (5, 3, 2)),
        # Inwards, both: columns 5 and 6.
        ({"sides": 0xFF}, (3, 2, 1)),
        # The half turns lie a line higher: the last line of the block is empty.
        ({"raised": 1}, (4, 2, 1)),
        # A fraction is not turned.
        ({"sides": 0xFF, "mode": 1}, (2, 1, 1)),
    ],
)
def test_known_shapes_of_plane_words(fields, expected):
    words = pw.array_of([pw.encode([(0, 3)] * 4, **{"mode": 0, **fields})])
    halves = halves_of(words, PLANE)
    assert tuple(int(least_lane_cycles(*halves, pixels)[0]) for pixels in (2, 4, 8)) == expected


ROW = [(0, 7), *cw.NOTHING[1:]]
"""Eight pixels of the line four above the engine's: two cycles of ``paper``'s lanes, one of
``swift``'s."""


def rows_at(*lines, across=64, width=512, config=PAPER):
    """A frame in which each of some lines, 4 and below, is filled with so many rows of pixels."""
    words, at = [], 0
    for line in lines:
        words.append(cw.advance(line + 4 - at))
        words += [cw.encode(ROW, x=8 * n, mode=1, config=config) for n in range(across)]
        at = line + 4
    return cw.make_frame([*words, cw.end()], (width, 512), config=config)


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        # A line of 512 pixels: 64 rows of two cycles, and 128 beats.
        ((9,), 128 + 128),
        # The first of two lines leaves while the other one is drawn.
        ((9, 10), 128 + 128 + 128),
        ((0, 15), 128 + 128 + 128),
        # Its place is free after 256 cycles: the row that waited ends in the next one.
        ((0, 16), 256 + 1 + 63 * 2 + 128),
    ],
)
def test_a_line_leaves_once_it_is_drawn_and_gives_its_place_to_another(lines, expected):
    assert bound_cycles(rows_at(*lines)) == expected


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ((9,), 64 + 32),
        ((9, 10), 64 + 64 + 32),
        ((0, 15), 64 + 64 + 32),
        # Nothing of the second line is drawn while the first one leaves its place to it.
        ((0, 16), 64 + 32 + 64 + 32),
    ],
)
def test_blocks_take_a_row_a_cycle_and_sixteen_pixels_a_beat(lines, expected):
    assert bound_cycles(rows_at(*lines, config=SWIFT)) == expected


def test_a_window_of_fewer_lines_holds_up_more():
    low = next(config for config in VARIANTS if config.window_lines == 8)
    tall = PAPER.replace(window_lines=low.window_lines * 2, pixels_per_word=low.pixels_per_word)
    frames = [rows_at(0, 9, across=8, config=config) for config in (low, tall)]
    first, second = map(bound_cycles, frames)
    assert first > second


def test_a_frame_of_nothing_takes_nothing():
    assert bound_cycles(cw.make_frame([cw.advance(9), cw.end()], (64, 64))) == 0


def knot(config, scale, **view):
    """The knot with splats of a scale."""
    quality = "exact" if config.plane else "paper"
    return scene_frame("knot", scale, view=view, config=config, quality=quality)


ENGINES = [*PRESETS.values(), *SHAPED[:1]]


@pytest.mark.parametrize("config", ENGINES, ids=lambda config: config.name)
def test_no_engine_takes_fewer(config):
    rng = np.random.default_rng(5)
    frames = [shapes(rng, 700, 200, 90, config=config)]
    frames += [knot(config, scale, size=(128, 96)) for scale in (1, 3)]
    for frame in frames:
        bound = bound_cycles(frame)
        assert 0 < bound <= count_cycles(frame, after_reset=False) < 3 * bound
    # What lies outside the image takes little, and what lies behind the end word nothing.
    frames = [nonsense(rng, 700, width, 40, config=config) for width in (60, 64, 7)]
    frames.append(knot(config, 3, size=(128, 128), zoom=8.0))
    whole = [word(cw.EVERYTHING, 0, 0, mode=0, config=config)] * 300
    frames.append(random_frames.frame_of(whole, 64, 2, config=config))
    below = [advance_word(70, config), *whole]
    frames.append(random_frames.frame_of(below, 64, 64, config=config))
    for frame in frames:
        assert bound_cycles(frame) <= count_cycles(frame, after_reset=False)


def test_words_behind_the_end_word_take_nothing():
    frame = rows_at(9)
    more = dataclasses.replace(frame, codewords=np.tile(frame.codewords, 3))
    assert bound_cycles(more) == bound_cycles(frame)
