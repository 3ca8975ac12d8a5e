"""Encoded splats, drawn by the golden renderer, against the ellipse evaluated pixel by pixel."""

import numpy as np
import pytest

from splatline.host.encode import depth_codes, encode
from splatline.host.frame import Frame, Tables
from splatline.host.order import sort_by_line
from splatline.host.project import Splats
from splatline.host.shapes import level_slopes
from splatline.rtl.format import PAPER
from splatline.sim import golden

TABLES = Tables(np.zeros(3, np.int64), np.zeros((128, 3), np.int64), np.zeros((128, 3), np.int64))


def splats_of(column, line, diameter, shape):
    def as_kind(values, kind):
        return np.atleast_1d(np.asarray(values, kind))

    count = len(as_kind(column, float))
    return Splats(
        np.arange(count),
        as_kind(column, np.float32),
        as_kind(line, np.float32),
        np.ones(count),
        as_kind(diameter, np.float32),
        as_kind(shape, np.uint16),
        np.zeros(count, np.uint16),
        {},
    )


def encoded(splats, width, height, z=5):
    count = len(splats)
    zeros = np.zeros(count, np.uint16)
    codes = np.full(count, z, np.uint16)
    return encode(splats, codes, zeros, zeros, zeros.astype(np.uint8), width, height, PAPER)


def drawn(splats, width, height):
    words = encoded(splats, width, height)
    stream, _ = sort_by_line(words.words, words.lines, PAPER)
    return golden.render(Frame(stream, TABLES, width, height)).drawn


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
    for _ in range(300):
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
        assert len(encoded(splats_of(100, 100, diameter, flat), 512, 512).words) == words
    # Symmetric at whole places: across the left or upper border the halves go apart.
    assert len(encoded(splats_of(2, 100, 6.0, flat), 512, 512).words) == 2
    assert len(encoded(splats_of(100, -1, 6.0, flat), 512, 512).words) == 1


def test_nothing_becomes_a_control_word_by_accident():
    rng = np.random.default_rng(4)
    count = 20_000
    splats = splats_of(
        rng.uniform(-20, 90, count),
        rng.uniform(-20, 90, count),
        rng.uniform(0, 40, count),
        rng.integers(0, 4096, count),
    )
    words = encoded(splats, 64, 64)
    fields = golden.decode(words.words, PAPER)
    assert not fields["control"].any()
    assert (words.lines >= 0).all()
    assert (words.lines < 64 + 4).all()
    assert (fields["x"] < 64).all()


@pytest.mark.parametrize("diameter", [5e3, 1e7, 1e12, 1e30])
def test_the_largest_splats_fill_the_image_in_no_more_words_than_it_has_blocks(diameter):
    splats = splats_of(30, 30, diameter, 32 * 64 + 32)
    assert drawn(splats, 64, 64).all()
    assert len(encoded(splats, 64, 64).words) <= 17 * 9


@pytest.mark.parametrize("shape", [0, 63, 63 * 64, 4095, 32, 32 * 64])
def test_no_splat_in_view_is_empty_however_thin_and_large(shape):
    rng = np.random.default_rng(shape)
    for diameter in rng.uniform(2, 60, 60):
        splats = splats_of(*rng.uniform(8, 56, 2), diameter, shape)
        assert drawn(splats, 64, 64).any()


def test_depths_fill_their_range_and_leave_the_background_free():
    codes, limits = depth_codes(np.array([3.0, 1.0, 2.0]), PAPER)
    assert codes.tolist() == [510, 0, 255]
    assert limits == (1.0, 3.0)
    assert depth_codes(np.full(4, 7.0), PAPER)[0].tolist() == [0] * 4
    assert len(depth_codes(np.zeros(0), PAPER)[0]) == 0
    tiny, _ = depth_codes(np.array([1e-300, 3e-300]), PAPER)
    assert tiny.tolist() == [0, 510]
