"""Small areas of background within one surface are found, and true gaps are not."""

import numpy as np
import pytest

from splatline.contract.presets import PLANE, RGB24
from splatline.host.encode.areas import REACH, find_areas

BACKGROUND = RGB24.background_depth

FULL = sum(7 << RGB24.last(row).lsb for row in range(4)) | 1
"""A word of four rows of eight pixels."""

DOT = 1 | 1 << RGB24.first(1).lsb | 1 << RGB24.first(2).lsb | 1 << RGB24.first(3).lsb
"""A word of one pixel: rows whose first column is behind their last are empty."""

PAIR = DOT - (1 << RGB24.first(1).lsb) + sum(1 << RGB24.last(row).lsb for row in (0, 1))
"""A word of two rows of two pixels."""

HOLES = {
    "one": [(0, 0)],
    "square": [(0, 0), (0, 1), (1, 0), (1, 1)],
    "ring": [(y, x) for y in range(3) for x in range(3) if (y, x) != (1, 1)],
    "stair": [(0, 0), (0, 1), (1, 1), (1, 2), (2, 2)],
    "left of its first": [(0, 2), (1, 2), (1, 1), (1, 0), (2, 0)],
    "touching at corners": [(0, 2), (1, 1), (1, 3), (2, 0), (3, 1)],
}


def surface(down=1.5, right=-2.0, size=(20, 24)):
    """Depths of a plane that leans, rounded."""
    y, x = np.mgrid[: size[0], : size[1]]
    return np.round(200.0 + down * y + right * x).astype(np.int32)


def with_hole(depth, pixels, at=(8, 9)):
    pierced = depth.copy()
    for y, x in pixels:
        pierced[at[0] + y, at[1] + x] = BACKGROUND
    return pierced


def found(depth, word=FULL):
    """The pixels of areas, and their sources, as lists of line and column."""
    owner = np.where(depth < BACKGROUND, 0, -1).astype(np.int32)
    pixels, sources = find_areas(depth, owner, np.array([word], np.uint64), RGB24)
    width = depth.shape[1]
    return [np.stack(np.divmod(numbers, width), axis=1) for numbers in (pixels, sources)]


def is_found(depth, word=FULL):
    """Whether all of the background is found; else nothing may be."""
    pixels, _ = found(depth, word)
    count = np.count_nonzero(depth == BACKGROUND)
    assert len(pixels) in (0, count)
    return len(pixels) == count


@pytest.mark.parametrize("name", HOLES)
def test_a_hole_in_a_plane_takes_the_nearest_pixels_about_it(name):
    depth = with_hole(surface(), HOLES[name])
    pixels, sources = found(depth)
    hole = np.argwhere(depth == BACKGROUND)
    assert sorted(pixels.tolist()) == hole.tolist()
    drawn = np.argwhere(depth < BACKGROUND)
    touching = drawn[(np.abs(drawn[:, np.newaxis] - hole).max(axis=2) == 1).any(axis=1)]
    for pixel, source in zip(pixels, sources, strict=True):
        assert source.tolist() in touching.tolist()
        least = ((touching - pixel) ** 2).sum(axis=1).min()
        assert ((source - pixel) ** 2).sum() == least


def test_a_gap_between_a_near_part_and_a_far_one_stays():
    near, far = surface(), surface() + 60
    depth = np.where(np.arange(24) < 10, near, far).astype(np.int32)
    assert not is_found(with_hole(depth, HOLES["square"]))
    assert is_found(with_hole(near, HOLES["square"]))


def test_a_gap_beside_a_surface_that_turns_away_stays():
    """A cylinder ends at column 10; a wall as near as its edge is behind the gap."""
    x = np.arange(24)
    cylinder = 300.0 - 200.0 * np.sqrt(np.maximum(1.0 - (x / 10.0) ** 2, 0.0))
    depth = np.tile(np.where(x <= 10, cylinder, 300.0), (20, 1)).astype(np.int32)
    assert not is_found(with_hole(depth, [(0, 0), (0, 1), (1, 0), (1, 1)], (8, 10)))


def test_depths_may_lie_a_little_off_a_plane():
    """The bound is 10/511 of the depth range: one pixel of many pulls the plane by little."""
    for off, closed in ((8, True), (14, False)):
        depth = with_hole(surface(), HOLES["square"])
        depth[9, 8] += off
        assert is_found(depth) == closed


@pytest.mark.parametrize(("side", "word", "closed"), [
    (3, DOT, True), (4, DOT, False), (4, PAIR, True), (5, PAIR, False), (5, FULL, True),
    (6, FULL, False),
])  # fmt: skip
def test_a_hole_more_than_twice_as_wide_as_the_words_about_it_stays(side, word, closed):
    """Of six lines and columns it has 36 pixels, which are too many."""
    square = [(y, x) for y in range(side) for x in range(side)]
    assert is_found(with_hole(surface(), square), word) == closed


@pytest.mark.parametrize(("length", "closed"), [(7, True), (8, False)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_long_hole_stays(length, closed, turned):
    line = [(0, k) if turned else (k, 0) for k in range(length)]
    assert is_found(with_hole(surface(), line)) == closed


@pytest.mark.parametrize("beside", [(0, 2), (2, 2), (2, 0), (-2, 1)])
def test_a_frayed_outline_stays(beside):
    """Other background is within two pixels."""
    assert not is_found(with_hole(surface(), [(0, 0), beside]))


def test_two_holes_further_apart_are_both_closed():
    assert is_found(with_hole(surface(), [(0, 0), (0, 3), (1, 3), (5, 1)]))


@pytest.mark.parametrize(("at", "closed"), [
    ((2, 2), True), ((1, 9), False), ((8, 1), False), ((18, 9), False), ((8, 22), False),
    ((17, 21), True),
])  # fmt: skip
def test_at_the_border_of_the_image_nobody_knows(at, closed):
    assert is_found(with_hole(surface(), [(0, 0)], at)) == closed


def test_the_outside_is_no_area():
    depth = np.full((20, 24), BACKGROUND, np.int32)
    depth[6:14, 5:15] = 100
    assert len(found(depth)[0]) == 0


@pytest.mark.parametrize("way", [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_no_pixel_beyond_the_reach_matters(way):
    """A tile has to draw as much beside its own pixels, and no more."""
    cross = [(k, 3) for k in range(7)] + [(3, k) for k in range(7)]
    depth = with_hole(surface(size=(40, 40)), cross, (18, 18))
    pixels, _ = found(depth)
    assert len(pixels) == 13
    lines, columns = np.mgrid[:40, :40]
    along = way[0] * lines + way[1] * columns
    last = min(pixels @ way)
    for reach, still in ((REACH, 13), (REACH - 1, 0)):
        assert len(found(np.where(along > last + reach, BACKGROUND, depth))[0]) == still


def test_words_with_planes_have_extents_too():
    depth = with_hole(surface(), [(y, x) for y in range(4) for x in range(4)])
    owner = np.where(depth < BACKGROUND, 0, -1).astype(np.int32)
    depth[depth == BACKGROUND] = PLANE.background_depth
    for word, count in ((FULL, 16), (DOT, 0)):
        words = np.array([[word, 0]], np.uint64)
        assert len(find_areas(depth, owner, words, PLANE)[0]) == count
