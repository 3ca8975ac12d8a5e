"""Beats of an initial raster that are out of place (``docs/contract.md``, "Raster")."""

import numpy as np

from splatline.contract.presets import PAPER
from splatline.contract.raster_beats import from_beats, to_beats
from splatline.sim.cosim.faults.frames import random_raster
from splatline.sim.cosim.faults.loaded import loaded_raster

WIDTH, HEIGHT = 41, 30
RASTER = random_raster(np.random.default_rng(2), WIDTH, HEIGHT, 0.2, PAPER)
BEATS = to_beats(RASTER)[:-1]


def lines_of(beats):
    field = PAPER.raster_line
    high, shift = divmod(field.lsb, 64)
    return beats[:, high] >> np.uint64(shift) & np.uint64(field.mask)


def test_a_whole_raster_is_itself():
    assert loaded_raster(BEATS, WIDTH, HEIGHT, PAPER).mismatches(RASTER) == 0


def test_beats_outside_a_smaller_image_are_dropped():
    part = loaded_raster(BEATS, 17, 9, PAPER)
    np.testing.assert_array_equal(part.depth, RASTER.depth[:9, :17])
    np.testing.assert_array_equal(part.colour, RASTER.colour[:9, :17])


def test_a_line_above_the_one_before_is_dropped():
    swapped = np.concatenate([BEATS[lines_of(BEATS) >= 10], BEATS[lines_of(BEATS) < 10]])
    wanted = RASTER.depth.copy()
    wanted[:10] = PAPER.background_depth
    np.testing.assert_array_equal(loaded_raster(swapped, WIDTH, HEIGHT, PAPER).depth, wanted)


def test_of_a_word_that_comes_twice_the_second_counts():
    other = to_beats(random_raster(np.random.default_rng(3), WIDTH, HEIGHT, 0.9, PAPER))[:-1]
    line = 12
    both = np.concatenate([BEATS[lines_of(BEATS) <= line], other[lines_of(other) == line]])
    wanted = from_beats(np.concatenate([other, to_beats(RASTER)[-1:]]), WIDTH, HEIGHT, PAPER)
    drawn = loaded_raster(both, WIDTH, HEIGHT, PAPER)
    np.testing.assert_array_equal(drawn.depth[line], wanted.depth[line])
