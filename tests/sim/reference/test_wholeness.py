"""Pinholes and pixels that are seen through."""

from types import SimpleNamespace

import numpy as np
import pytest

from splatline.sim.reference.reference import Reference
from splatline.sim.reference.wholeness import (
    LARGEST_GAP,
    STEP,
    behind_truth,
    largest_gap,
    pinholes,
    see_through,
    wholeness,
)


def picture(drawn, depth):
    """A raster whose depth is given as a share of its range."""
    codes = np.where(drawn, np.rint(510 * depth), 511).astype(np.uint16)
    return SimpleNamespace(drawn=drawn, depth=codes, config=SimpleNamespace(background_depth=511))


def test_a_pinhole_is_background_with_seven_drawn_neighbours():
    drawn = np.ones((7, 7), bool)
    drawn[3, 3] = False
    assert pinholes(drawn).sum() == 1 and pinholes(drawn)[3, 3]
    drawn[3, 4] = False  # each has seven
    assert pinholes(drawn).sum() == 2
    drawn[4, 3] = False  # each has six
    assert not pinholes(drawn).any()


def test_outside_of_the_image_nothing_is_drawn():
    drawn = np.ones((4, 4), bool)
    drawn[0, 2] = False
    assert not pinholes(drawn).any()


def test_a_pixel_far_behind_its_neighbours_is_seen_through():
    depth = np.full((6, 6), 0.2)
    depth[2, 3] = 0.2 + 1.1 * STEP
    drawn = np.ones((6, 6), bool)
    assert np.argwhere(see_through(depth, drawn)).tolist() == [[2, 3]]
    depth[2, 3] = 0.2 + 0.9 * STEP
    assert not see_through(depth, drawn).any()


def test_background_has_no_part_in_the_median():
    depth = np.full((3, 3), 0.9)
    drawn = np.zeros((3, 3), bool)
    depth[1, :] = 0.1, 0.9, 0.1
    drawn[1, :] = True
    assert np.argwhere(see_through(depth, drawn)).tolist() == [[1, 1]]


def test_a_straight_edge_of_a_nearer_part_is_whole():
    depth = np.full((8, 8), 0.9)
    depth[:, :4] = 0.1
    assert not see_through(depth, np.ones((8, 8), bool)).any()


def test_shares_are_of_the_pixels_drawn():
    drawn = np.zeros((10, 10), bool)
    drawn[1:8, 1:8] = True
    drawn[4, 4] = False
    depth = np.full((10, 10), 0.1)
    depth[2, 2] = 0.9
    found = wholeness(picture(drawn, depth))
    assert found == {"pinholes": pytest.approx(1 / 48), "see_through": pytest.approx(1 / 48)}


def test_an_empty_picture_is_neither():
    empty = picture(np.zeros((5, 5), bool), np.zeros((5, 5)))
    assert wholeness(empty) == {"pinholes": 0.0, "see_through": 0.0}


def test_the_truth_says_what_lies_behind():
    truth = Reference(np.zeros((6, 6, 3)), np.full((6, 6), 5.0), np.ones((6, 6)))
    truth.depth[:, 3:] = 9.0
    depth = np.where(np.arange(6) < 3, 0.0, 1.0) * np.ones((6, 1))
    drawn = np.ones((6, 6), bool)
    assert behind_truth(picture(drawn, depth), truth, (5.0, 9.0)) == 0.0
    depth[2, 2] = 1.0  # beside the edge it may be the far part
    assert behind_truth(picture(drawn, depth), truth, (5.0, 9.0)) == 0.0
    depth[2, 0] = 1.0
    assert behind_truth(picture(drawn, depth), truth, (5.0, 9.0)) == pytest.approx(1 / 36)


def test_a_gap_is_a_small_area_of_background_within_a_surface():
    drawn = np.ones((40, 40), np.bool_)
    assert largest_gap(drawn) == 0
    drawn[5:8, 5:9] = False
    drawn[20, 20] = drawn[21, 21] = False  # they touch at a corner
    assert largest_gap(drawn) == 12
    drawn[5:8, 12] = False  # three columns of pixels lie between
    assert largest_gap(drawn) == 12
    drawn[5:8, 11] = False  # two columns
    assert largest_gap(drawn) == 18
    drawn[30:37, 3:9] = False
    assert largest_gap(drawn) == 18 < LARGEST_GAP < 42


def test_an_outline_with_frayed_pixels_has_no_gap():
    drawn = np.zeros((20, 20), np.bool_)
    drawn[5:15, 5:15] = True
    drawn[7:9, 7] = False  # two drawn columns before the background
    assert largest_gap(drawn) == 0
