"""Plane words: golden against the contract in plain Python."""

import dataclasses

import numpy as np
import pytest

from splatline.contract.codeword import decode_plane_word
from splatline.contract.errors import InputError
from splatline.contract.presets import PLANE
from splatline.contract.raster import Raster
from splatline.sim import golden
from tests.support import plane_words as pw
from tests.support.codewords import NOTHING as EMPTY
from tests.support.codewords import random_tables


def same(one, other):
    assert np.array_equal(one.depth, other.depth)
    assert np.array_equal(one.colour, other.colour)


@pytest.mark.parametrize("config", pw.CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("seed", range(3))
def test_random_words_are_drawn_by_the_contract(config, seed):
    rng = np.random.default_rng(seed)
    size = (40, 30) if config.x_bits > 6 else (33, 32)
    frame = pw.random_frame(rng, 300, size, config)
    expected = pw.draw(frame)
    assert expected.drawn.mean() > 0.3
    for bands in (1, 3):
        same(golden.render(frame, bands=bands), expected)


def test_a_frame_starts_from_a_raster():
    rng = np.random.default_rng(5)
    frame = pw.random_frame(rng, 60, (24, 20))
    depth = rng.integers(0, 4096, (20, 24)).astype(np.uint16)
    colour = rng.integers(0, 256, (20, 24, 3)).astype(np.uint8)
    colour[depth == 4095] = 0
    initial = Raster(depth, colour, PLANE)
    same(golden.render(frame, initial), pw.draw(frame, initial))


@pytest.mark.parametrize("scale", range(4))
@pytest.mark.parametrize(("a", "b"), [(63, 63), (-64, -64), (63, -64), (-64, 63), (1, 0), (0, -1)])
@pytest.mark.parametrize("z", [0, 1, 4096, 8190, 8191])
def test_every_sum_saturates_at_both_ends(scale, a, b, z):
    word = pw.encode([(0, 7)] * 4, mode=0, x=2, z=z, a=a, b=b, scale=scale, m=3, d=9)
    found = golden.render(pw.make_frame([pw.advance(4), word], (12, 8)))
    factor = (1, 2, 4, 16)[scale]
    for row in range(8):
        for column in range(8):
            total = 2 * z + factor * (a * column + b * row)
            assert -(1 << 15) <= total < 1 << 15  # as the contract says
            assert found.depth[row, column + 2] == min(max(total // 4, 0), 4095)
    assert (found.depth[:, [0, 1, 10, 11]] == 4095).all()


@pytest.mark.parametrize("config", pw.CONFIGS, ids=lambda config: config.name)
def test_every_extreme_at_every_place_is_drawn_by_the_contract(config):
    seen = set()
    for frame in pw.extreme_frames(config):
        found = golden.render(frame)
        same(found, pw.draw(frame))
        seen |= set(np.unique(found.depth).tolist())
    assert {0, config.background_depth - 1} <= seen


def test_a_pixel_at_the_depth_of_the_background_or_beyond_is_not_drawn():
    word = pw.encode([(0, 7)] * 4, x=0, z=8184, a=1)  # 4092, 4092 1/4, ...
    found = golden.render(pw.make_frame([pw.advance(4), word], (8, 4)))
    assert found.depth[0].tolist() == [4092] * 4 + [4093] * 4
    word = pw.encode([(0, 7)] * 4, x=0, z=8184, a=3)
    found = golden.render(pw.make_frame([pw.advance(4), word], (8, 4)))
    assert found.depth[0].tolist() == [4092, 4092, 4093, 4094] + [4095] * 4
    assert found.drawn[0].tolist() == [True] * 4 + [False] * 4
    word = pw.encode([(0, 7)] * 4, x=0, z=8191, a=63, b=63, scale=3)
    assert not golden.render(pw.make_frame([pw.advance(4), word], (8, 4))).drawn.any()


def test_of_equal_depths_the_first_drawn_stays_pixel_by_pixel():
    first = pw.encode([(0, 7)] * 4, x=0, z=200, a=4, d=1)
    second = pw.encode([(0, 7)] * 4, x=0, z=214, a=-4, d=2)
    frame = pw.make_frame([pw.advance(4), first, second], (8, 4))
    found = golden.render(frame)
    assert found.depth[0].tolist() == [100, 101, 102, 103, 103, 102, 101, 100]
    same(found, pw.draw(frame))


@pytest.mark.parametrize("raised", (0, 1))
@pytest.mark.parametrize("first_out", (0, 1))
@pytest.mark.parametrize("last_out", (0, 1))
def test_rows_are_rotated_and_moved(raised, first_out, last_out):
    rng = np.random.default_rng(raised + 2 * first_out + 4 * last_out)
    rows = np.empty((8, 2), np.int64)
    for sides in rng.integers(0, 256, 40):
        upper = [tuple(rng.integers(0, 8, 2).tolist()) for _ in range(4)]
        word = pw.encode(
            upper, mode=0, raised=raised, first_out=first_out, last_out=last_out, sides=int(sides)
        )
        low, high = pw.array_of([word]).view(np.int64)[0]
        decode_plane_word(low, high, rows)
        image = golden.render(pw.make_frame([pw.advance(4), word | 100 << 83], (8, 8)))
        for row in range(8):
            covered = [pw.covers(word, row, column) for column in range(8)]
            assert [rows[row, 0] <= column <= rows[row, 1] for column in range(8)] == covered
            assert image.drawn[row].tolist() == covered


def test_a_moved_row_may_vanish_and_stays_in_its_block():
    def drawn(rows, **fields):
        frame = pw.make_frame([pw.advance(4), pw.encode(rows, mode=0, **fields)], (16, 8))
        return golden.render(frame).drawn

    dot = [(3, 3), (1, 0), (1, 0), (1, 0)]
    assert drawn(dot).sum() == 2
    assert drawn(dot, sides=1).sum() == 1  # inwards: [5, 4]
    assert drawn(dot, sides=3, first_out=1, last_out=1)[7].nonzero()[0].tolist() == [3, 4, 5]
    wide = [(0, 7), (1, 0), (1, 0), (1, 0)]
    assert drawn(wide, sides=3, first_out=1, last_out=1)[7].nonzero()[0].tolist() == [*range(8)]
    empty = [(1, 0), (3, 4), (1, 0), (1, 0)]
    assert not drawn(empty, sides=3, first_out=1, last_out=1)[7].any()


def test_the_codes_for_half_pixels_mean_nothing():
    for rows in ([(2, 1), (3, 4), (2, 5), (2, 5)], [(1, 0), (1, 0), (3, 4), (5, 2)]):
        frame = pw.make_frame([pw.advance(4), pw.encode(rows, mode=0)], (8, 8))
        filled = [first <= last for first, last in rows]
        assert golden.render(frame).drawn.any(axis=1).tolist() == filled + filled[::-1]


def test_control_words_ignore_the_plane():
    noise = ((1 << 32) - 1) << 64 | 255 << 56
    words = [pw.encode([(0, 0)] * 4, z=7, x=5), pw.advance(6) | noise, pw.encode([(0, 0)] * 4, z=9)]
    frame = pw.make_frame(words, (8, 12))
    frame.codewords[-1] |= np.array([0, (1 << 32) - 1], np.uint64)
    same(golden.render(frame), pw.draw(frame))
    assert golden.render(frame).drawn[2:6, 0].all()


def test_bits_above_96_do_not_count():
    frame = pw.random_frame(np.random.default_rng(3), 50, (24, 20))
    noisy = frame.codewords | np.array([0, 0xFFFFFFFF << 32], np.uint64)
    same(golden.render(dataclasses.replace(frame, codewords=noisy)), golden.render(frame))


def test_a_frame_without_an_end_or_of_another_shape_is_refused():
    frame = pw.make_frame([pw.advance(4)], (8, 8))
    with pytest.raises(InputError, match="no end-of-frame word"):
        golden.render(dataclasses.replace(frame, codewords=frame.codewords[:-1]))
    with pytest.raises(InputError, match=r"must have the shape \(n, 2\), not \(2,\)"):
        golden.render(dataclasses.replace(frame, codewords=frame.codewords[:, 0].copy()))


def test_the_largest_colour_fits():
    config = pw.FLAT
    tables = random_tables(np.random.default_rng(0), config)
    word = pw.encode([(0, 0), *EMPTY[1:]], x=1, d=511, s=511, m=7, config=config)
    frame = pw.make_frame([pw.advance(4, config), word], (4, 4), tables, config)
    same(golden.render(frame), pw.draw(frame))
