"""Encoded splats, drawn by the golden renderer, against the ellipse evaluated pixel by pixel."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from splatline.contract.presets import PAPER
from splatline.host.encode.encode import encode
from splatline.host.encode.quality import QUALITIES
from splatline.host.shading.normal_levels import level_slopes
from splatline.host.visibility.view import View
from splatline.sim import golden
from tests.support.splats import picture_of, splats_of


def encoded(splats, width, height, quality="paper", depth_range=(0.5, 1.5), focal=1e6):
    """Words for splats; so long a focal length that none is seen aslant."""
    view = View(np.zeros(3), np.eye(3), focal, width, height, 0.1)
    splats = dataclasses.replace(splats, depth_range=depth_range)
    return encode(splats, view, PAPER, quality, nearest_pixel=True)


def words_of(splats, width, height, **options):
    return encoded(splats, width, height, **options).together()[0]


def picture(splats, width, height, **options):
    return picture_of(encoded(splats, width, height, **options), width, height)


def drawn(splats, width, height, **options):
    return picture(splats, width, height, **options).drawn


def ellipse_pixels(column, line, diameter, shape, width, height):
    """The stated rule: diameter rounded up, centre at a pixel corner; one pixel up to 1."""
    size = int(np.ceil(diameter))
    y, x = np.mgrid[:height, :width]
    if size <= 1:
        return (x == np.floor(column)) & (y == np.floor(line))
    dx = x + 0.5 - np.floor(column + 0.5)
    dy = y + 0.5 - np.floor(line + 0.5)
    slopes = level_slopes()
    across = slopes[shape // 64] * dx + slopes[shape % 64] * dy
    return dx * dx + dy * dy + across * across <= (size / 2) ** 2


@pytest.mark.parametrize("largest", [8, 16, 60])
def test_a_splat_covers_its_ellipse_anywhere_in_and_around_the_image(largest):
    rng = np.random.default_rng(largest)
    width, height = 61, 47
    for _ in range(150):
        diameter = np.float32(rng.uniform(0, largest))
        column = np.float32(rng.uniform(-10, width + 10))
        line = np.float32(rng.uniform(-10, height + 10))
        # Not so thin that the rule for empty ellipses would add a pixel.
        shape = int(rng.integers(12, 52)) * 64 + int(rng.integers(12, 52))
        expected = ellipse_pixels(column, line, diameter, shape, width, height)
        found = drawn(splats_of(column, line, diameter, shape), width, height)
        assert (found == expected).all() or not expected.any(), (column, line, diameter, shape)


def test_words_are_as_few_as_the_shape_allows():
    flat = 32 * 64 + 32
    for diameter, words in ((0.2, 1), (3.0, 1), (8.0, 1), (12.0, 8), (16.0, 8)):
        assert len(words_of(splats_of(100, 100, diameter, flat), 512, 512)) == words
    # Symmetric at whole places: across the left or upper border the halves go apart.
    assert len(words_of(splats_of(2, 100, 6.0, flat), 512, 512)) == 2
    assert len(words_of(splats_of(100, -1, 6.0, flat), 512, 512)) == 1


def test_nothing_becomes_a_control_word_by_accident():
    rng = np.random.default_rng(4)
    count = 20_000
    splats = splats_of(
        rng.uniform(-20, 90, count),
        rng.uniform(-20, 90, count),
        rng.uniform(0, 40, count),
        rng.integers(0, 4096, count),
    )
    words, lines = encoded(splats, 64, 64).together()
    fields = golden.decode(words, PAPER)
    assert not fields["control"].any()
    assert (lines >= 0).all()
    assert (lines < 64 + 4).all()
    assert (fields["x"] < 64).all()


@pytest.mark.parametrize("quality", ["paper", "fast", "exact"])
@pytest.mark.parametrize("diameter", [5e3, 1e7, 1e12, 1e30, 1e38, np.inf])
def test_the_largest_splats_fill_the_image_in_no_more_words_than_it_has_blocks(diameter, quality):
    splats = splats_of(30, 30, diameter, 32 * 64 + 32)
    assert drawn(splats, 64, 64, quality=quality).all()
    assert len(words_of(splats, 64, 64, quality=quality)) <= 17 * 9


@pytest.mark.parametrize("shape", [0, 63, 63 * 64, 4095, 32, 32 * 64])
def test_no_splat_in_view_is_empty_however_thin_and_large(shape):
    rng = np.random.default_rng(shape)
    for diameter in rng.uniform(2, 60, 60):
        splats = splats_of(*rng.uniform(8, 56, 2), diameter, shape)
        assert drawn(splats, 64, 64).any()


def true_ellipse(column, line, diameter, slope, width, height):
    """Pixels whose centres lie in the ellipse about the true centre, and those on its border."""
    y, x = np.mgrid[:height, :width] + 0.5
    dx, dy = x - column, y - line
    across = slope[0] * dx + slope[1] * dy
    distance = dx * dx + dy * dy + across * across - (diameter / 2) ** 2
    return distance <= 0, np.abs(distance) < 1e-3 * max(diameter, 1.0) ** 2


@pytest.mark.parametrize("largest", [4, 12, 70])
def test_an_exact_splat_covers_its_true_ellipse(largest):
    rng = np.random.default_rng(largest)
    width, height = 61, 47
    for _ in range(150):
        diameter = np.float32(rng.uniform(0.5, largest))
        column = np.float32(rng.uniform(-10, width + 10))
        line = np.float32(rng.uniform(-10, height + 10))
        slope = np.float32(rng.normal(size=2) * rng.choice([0.3, 3.0]))
        splats = splats_of(column, line, diameter, 0, slope)
        found = drawn(splats, width, height, quality="exact")
        expected, near = true_ellipse(column, line, diameter, slope, width, height)
        if expected.any():
            assert ((found == expected) | near).all(), (column, line, diameter, slope)
        else:
            assert found.sum() <= 1 or near.any()


@pytest.mark.parametrize("steepness", [10.0, 1e3, 1e6])
@pytest.mark.parametrize("focal", [400.0, 1e6])
def test_a_splat_seen_edge_on_stays_within_its_own_radius(steepness, focal):
    """Where rounding would make its ellipse an endless line."""
    rng = np.random.default_rng(10)
    y, x = np.mgrid[:200, :200] + 0.5
    for _ in range(100):
        slope = steepness * rng.normal(size=2)
        diameter, column, line = rng.uniform(2, 20), *rng.uniform(30, 170, 2)
        splats = splats_of(column, line, diameter, 0, slope)
        found = drawn(splats, 200, 200, quality="exact", focal=focal)
        far = np.hypot(x - column, y - line)[found]
        # Seen aslant a disc reaches up to 1 + |a| times its radius (see conic).
        assert far.max() <= max(0.5 * diameter * 1.5, 1.0), (slope, diameter, column, line)


def test_a_thin_exact_splat_is_the_pixel_it_lies_in():
    found = drawn(splats_of(20.9, 10.2, 0.3, 0, (50.0, 3.0)), 61, 47, quality="exact")
    assert np.argwhere(found).tolist() == [[10, 20]]


def test_exact_takes_no_more_words_than_its_lines_and_columns_need():
    rng = np.random.default_rng(8)
    for _ in range(200):
        diameter, column, line = rng.uniform(1, 4), *rng.uniform(8, 500, 2)
        splats = splats_of(column, line, diameter, 0)
        words = words_of(splats, 512, 512, quality="exact")
        lines = np.flatnonzero(drawn(splats, 512, 512, quality="exact").any(axis=1))
        assert len(words) == -(-len(lines) // 4)


def test_fast_is_one_word_for_all_that_fits_a_block():
    rng = np.random.default_rng(9)
    count = 3000
    slope = rng.normal(size=(count, 2))
    shape = rng.integers(0, 4096, count)
    splats = splats_of(*rng.uniform(10, 500, (2, count)), rng.uniform(0.1, 8, count), shape, slope)
    words = encoded(splats, 512, 512, quality="fast")
    assert len(words.together()[0]) == count == words.elements
    fields = golden.decode(words.together()[0], PAPER)
    small = splats.data["diameter"] < 3
    assert (fields["mode"][small] == 1).all()  # at most four lines: at their true place
    assert (fields["mode"] == 0).any()


def pixels_beyond_a_block(column, line, diameter, slope):
    """Return how many pixels of an ellipse the block about its nearest half pixel lacks, or None.

    None: a pixel's centre is so near to the border that one cannot tell.
    """
    whole, near = true_ellipse(column, line, diameter, slope, 80, 80)
    if near.any():
        return None
    x, y = np.floor(2.0 * column + 0.5) / 2.0, np.floor(2.0 * line + 0.5) / 2.0
    v, u = np.mgrid[:80, :80] + 0.5
    # At a half pixel the upper lines reach a pixel further left, and the lower ones further right.
    has = (abs(v - y) < 4) * np.clip(4.5 - abs(u - x), 0.0, 1.0)
    return np.sum(whole * (1.0 - has))


def test_a_larger_fast_splat_is_one_word_if_a_block_lacks_few_pixels_of_it():
    """Of its true ellipse about a half pixel it lacks pixels at the block's border alone."""
    rng = np.random.default_rng(10)
    fit, lacking = 0, 0
    for _ in range(300):
        diameter, column, line = rng.uniform(8.01, 13.0), *rng.uniform(20, 60, 2)
        slope = rng.normal(size=2) * rng.choice([0.05, 3.0])
        splats = splats_of(column, line, diameter, 0, slope)
        one = len(words_of(splats, 80, 80, quality="fast")) == 1
        # The box of d'(I + n n')d <= r^2 has half sides r sqrt of the inverse's diagonal.
        box = diameter * np.sqrt(np.diag(np.linalg.inv(np.eye(2) + np.outer(slope, slope))))
        lines = true_ellipse(column, line, diameter, slope, 80, 80)[0].any(axis=1).sum()
        beyond = pixels_beyond_a_block(column, line, diameter, slope)
        if abs(box.max() - 10.0) < 1e-3 or lines <= 4 or beyond is None:
            continue
        assert one == (box.max() < 10.0 and beyond <= 1.5), (diameter, slope)
        lacking += one and beyond >= 1
        if not one:
            continue
        fit += 1
        found = drawn(splats, 80, 80, quality="fast")
        fits = False
        for x in (*half_pixels_by(column), np.round(column)):
            for y in (*half_pixels_by(line), np.round(line)):
                whole, near = true_ellipse(x, y, diameter, slope, 80, 80)
                v, u = np.mgrid[:80, :80] + 0.5
                border = np.maximum(abs(u - x), abs(v - y)) > 3.4
                fits |= ((found == whole) | near | (whole & border)).all()
        assert fits, (column, line, diameter, slope)
    assert fit > 15 and lacking > 3


def test_a_fast_splat_of_more_than_four_lines_lies_at_the_nearest_half_pixel():
    """Its true ellipse about there, wherever one word can say so, and else about one next to it."""
    rng = np.random.default_rng(11)
    width, height = 61, 47
    nearest = 0
    for _ in range(600):
        slope = np.float32(rng.normal(size=2) * rng.choice([0.0, 0.3, 1.5]))
        diameter = np.float32(rng.uniform(4.2, 7.9))
        column = np.float32(rng.uniform(-5, width + 5))
        line = np.float32(rng.uniform(-5, height + 5))
        splats = splats_of(column, line, diameter, 0, slope)
        words = words_of(splats, width, height, quality="fast")
        truth, _ = true_ellipse(column, line, diameter, slope, width, height)
        if truth.any(axis=1).sum() <= 4:
            continue  # a fraction at its true place
        assert len(words) <= 2
        found = drawn(splats, width, height, quality="fast")
        places = []
        for x in half_pixels_by(column):
            for y in half_pixels_by(line):
                whole, near = true_ellipse(x, y, diameter, slope, width, height)
                off = np.hypot(x - column, y - line)
                places.append((off, ((found == whole) | near).all(), x, y, whole))
        places.sort(key=lambda place: place[0])
        assert any(same for _, same, *_ in places), (column, line, diameter, slope)
        _, same, x, y, whole = places[0]
        away, _ = true_ellipse(x % 1 + 8, y % 1 + 8, diameter, slope, 17, 17)  # from the borders
        rows = away.any(axis=1).sum()
        in_a_line = rows <= 7 and away[8].sum() >= 2  # of which it says so by two of its pixels
        can_say = in_a_line if y % 1 else x % 1 == 0 or rows <= 6
        assert same or not can_say, (column, line, diameter, slope)
        nearest += same
    assert nearest > 200


@pytest.mark.parametrize("focal", [30.0, 1e6])
def test_a_fast_splat_is_its_own_half_turn_however_wide(focal):
    """About half a pixel at the most from its centre; seen aslant it is wider than its diameter."""
    rng = np.random.default_rng(12)
    wide = 0
    for _ in range(300):
        diameter, column, line = rng.uniform(4.5, 8.0), *rng.uniform(20, 60, 2)
        slope = rng.normal(size=2) * 0.2
        splats = splats_of(column, line, diameter, 0, slope)
        if len(words_of(splats, 80, 80, quality="fast")) > 1:
            continue  # drawn in perspective
        found = drawn(splats, 80, 80, quality="fast")
        lines, columns = (np.flatnonzero(found.any(axis=axis)) for axis in (1, 0))
        if len(lines) <= 4:
            continue
        wide += len(columns) == 8
        own = found[lines[0] : lines[-1] + 1, columns[0] : columns[-1] + 1]
        assert (own == own[::-1, ::-1]).all(), (column, line, diameter, slope)
        if focal > 1e5:  # else the ellipse's middle is not the disc's
            assert abs(lines[0] + lines[-1] + 1 - 2 * line) <= 1.001
            assert abs(columns[0] + columns[-1] + 1 - 2 * column) <= 1.001
    assert wide > 5


def half_pixels_by(place):
    """The two multiples of a half on either side."""
    return np.floor(2 * place) / 2, np.floor(2 * place) / 2 + 0.5


def test_a_splat_at_a_half_pixel_is_whole_across_the_left_and_the_upper_border():
    """There it goes as two fractions: the same pixels as of one word, moved."""
    for column, line in ((8.5, 8.5), (8.0, 8.5), (8.5, 8.0)):
        splats = splats_of(column, line, 5.4, 0, (0.2, 0.1))
        inside = drawn(splats, 24, 24, quality="fast")
        assert len(words_of(splats, 24, 24, quality="fast")) == 1
        for dx, dy in ((-6, 0), (0, -6), (-7, -7)):
            moved = splats_of(column + dx, line + dy, 5.4, 0, (0.2, 0.1))
            found = drawn(moved, 24, 24, quality="fast")
            expected = np.zeros_like(inside)
            expected[: 24 + dy, : 24 + dx] = inside[-dy:, -dx:]
            assert (found == expected).all(), (column, line, dx, dy)


def depth_error(slope, quality):
    """How far a large disc's pixels lie from its plane, in steps of 9 bits: most, mean, words.

    A pixel is 1e-6 of the distance, and the range 1e-4 of it: so a slope changes the depth by a
    hundredth of itself from pixel to pixel, of the range's whole.
    """
    column, line = 30.0, 24.0
    splats = splats_of(column, line, 40.0, slope=slope)
    options = {"quality": quality, "depth_range": (1 - 5e-5, 1 + 5e-5)}
    found = picture(splats, 61, 47, **options)
    y, x = np.mgrid[:47, :61] + 0.5
    plane = (0.5 - 0.01 * (slope[0] * (x - column) + slope[1] * (y - line))) * 510
    off = np.abs(found.depth - plane)[found.drawn]
    return off.max(), off.mean(), len(words_of(splats, 61, 47, **options))


@pytest.mark.parametrize("quality", ["fast", "exact"])
@pytest.mark.parametrize("slope", [(-0.4, 0.7), (0.1, -1.2), (0.9, 0.0), (0.02, 0.03)])
def test_each_fraction_has_the_depth_of_the_plane_at_its_own_place(slope, quality):
    most, _, _ = depth_error(slope, quality)
    across, down = 5.1 * np.abs(slope)  # steps of 9 bits a pixel
    # A pixel's centre leaves that of 8 x 4 pixels by 3.5 and 1.5 at the most, or, of pixels at a
    # curved rim, by some more; and rounding by half a step.
    columns, lines = 4.5, 2.5
    if quality == "exact" and 7 * across + 3 * down > 3:
        columns, lines = (2.5, 2.5) if 8 * across >= 4 * down else (4.5, 1.5)
    assert most <= across * columns + down * lines + 0.5


@pytest.mark.parametrize("slope", [(0.3, 0.1), (-0.1, 0.9), (0.8, -0.8)])
def test_a_steep_fraction_is_halved_where_it_is_steeper(slope):
    coarse, fine = depth_error(slope, "fast"), depth_error(slope, "exact")
    assert fine[0] < 0.75 * coarse[0]
    assert fine[1] < 0.75 * coarse[1]
    assert 1.4 * coarse[2] < fine[2] <= 2.4 * coarse[2]


def test_a_flat_fraction_stays_whole():
    # 7 x 0.0008 + 3 x 0.00005 of the range is 2.9 of 512; more than 3 are steep.
    assert depth_error((0.08, 0.005), "exact") == depth_error((0.08, 0.005), "fast")
    assert depth_error((0.085, 0.005), "exact")[2] > depth_error((0.085, 0.005), "fast")[2]


@pytest.mark.parametrize("slope", [(9.0, 0.0), (0.0, 9.0)])
def test_a_steep_splat_that_fills_the_image_takes_twice_the_words(slope):
    splats = splats_of(30, 30, 1e3, slope=slope)
    options = {"depth_range": (1 - 5e-5, 1 + 5e-5)}
    fine = words_of(splats, 64, 64, quality="exact", **options)
    assert len(fine) == 2 * len(words_of(splats, 64, 64, quality="fast", **options))


def depths_drawn(depths, depth_range):
    splats = splats_of(20.0 * (1 + np.arange(len(depths))), 20.0, 3.0, slope=(0.0, 0.0))
    splats.data["depth"] = depths
    found = picture(splats, 100, 40, quality="exact", depth_range=depth_range)
    return [int(found.depth[19, 20 * (1 + i)]) for i in range(len(depths))]


def test_depths_fill_their_range_and_are_held_to_it():
    assert depths_drawn([1.0, 2.0, 3.0], (1.0, 3.0)) == [0, 255, 510]
    assert depths_drawn([1e-300, 3e-300], (1e-300, 3e-300)) == [0, 510]
    assert depths_drawn([0.5, 4.0], (1.0, 3.0)) == [0, 510]
    assert depths_drawn([7.0, 7.0], (7.0, 7.0)) == [0, 0]


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(list(QUALITIES)),
    st.floats(0.01, 300),
    st.floats(0.05, 1e4),
    st.sampled_from([0.0, 1e-300, 1e-6, 1e-3, 0.1, 1.0]),
)
@settings(max_examples=120, deadline=None)
def test_no_chunk_outgrows_the_room_measured_for_it(seed, quality, largest, focal, depth_range):
    rng = np.random.default_rng(seed)
    count = 50
    slope = rng.normal(size=(count, 2)) * 10.0 ** rng.uniform(-2, 6, (count, 1))
    places = rng.uniform(-30, 90, (2, count))
    splats = splats_of(*places, rng.uniform(0, largest, count), slope=slope)
    # A chunk each, so that none hides behind what another leaves.
    each = np.arange(count)
    splats = dataclasses.replace(
        splats, starts=each, stops=each + 1, nearest=np.ones(count), culled={}
    )
    depths = 1.0 - 0.5 * depth_range, 1.0 + 0.5 * depth_range
    found = encoded(splats, 64, 47, quality=quality, focal=focal * 100, depth_range=depths)
    room = np.diff([*found.starts, len(found.words)])
    taken = found.stops - found.starts
    assert (taken <= room).all()
    assert (found.counts.sum(axis=1) == taken).all()


@pytest.mark.parametrize("quality", list(QUALITIES))
@pytest.mark.parametrize("height", [45, 46, 47, 48])
def test_the_room_holds_a_splat_that_fills_the_image_wherever_its_blocks_begin(height, quality):
    """Of 46 lines, which 12 blocks of four would hold, 13 blocks may have some."""
    rng = np.random.default_rng(height)
    count = 40
    places = rng.uniform((0, 0), (201, height), (count, 2)).T
    slope = rng.normal(size=(count, 2)) * 0.1
    splats = splats_of(*places, rng.uniform(500, 3000, count), slope=slope)
    each = np.arange(count)
    splats = dataclasses.replace(splats, starts=each, stops=each + 1, nearest=np.ones(count))
    found = encoded(splats, 201, height, quality=quality)
    taken = found.stops - found.starts
    assert (taken <= np.diff([*found.starts, len(found.words)])).all()
    assert taken.min() >= 26 * (height // 4)
