"""Compact words, against the shape table and the definition of a fraction."""

import numpy as np
import pytest

from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER
from splatline.contract.variants import SHAPED
from splatline.host.encode.shape_table import EMPTY_SCANS, SIZES, shape_table
from splatline.host.encode.sort_by_line import end_word
from splatline.host.encode.write_words import half_turn
from splatline.sim import golden
from splatline.sim.golden.compact_words import expand, expand_frame
from tests.support.rom_words import compact_words, every_entry, mixed_words

SMALL, FULL = SHAPED


def field(words, place):
    return (words >> np.uint64(place.lsb)).astype(np.int64) & place.mask


def test_every_small_entry_is_the_table_s():
    words = every_entry(SMALL, np.random.default_rng(1))
    expanded, origins = expand(words, SMALL)
    assert np.array_equal(origins, np.arange(len(words)))
    assert np.array_equal(field(expanded, SMALL.scans), shape_table()[:9, ..., 0].ravel())
    assert not field(expanded, SMALL.mode).any()
    above = np.uint64(SMALL.diffuse.lsb)
    assert np.array_equal(expanded >> above, words >> above)


@pytest.mark.parametrize("size", range(9, SIZES))
def test_the_four_parts_of_a_large_shape_are_what_the_host_sends(size):
    """Against ``host.encode.paper_shapes``: four rows above the middle, four turned below."""
    rng = np.random.default_rng(size)
    for level_x, level_y in rng.integers(0, 64, (60, 2)):
        expected = [set() for _ in range(4)]
        for fraction, scans in enumerate(shape_table()[size, level_x, level_y].tolist()):
            if scans != EMPTY_SCANS:
                row, side = fraction // 2, fraction % 2
                expected[row].add((canonical(scans), 100 + 8 * side))
                expected[3 - row].add((canonical(half_turn(scans)), 100 + 8 * (1 - side)))
        for part in range(4):
            words = compact_words(FULL, size, level_x, level_y, part, rest=100 << FULL.x.lsb)
            expanded, _ = expand(words[np.newaxis], FULL)
            assert field(expanded, FULL.mode).all()
            scans, x = field(expanded, FULL.scans), field(expanded, FULL.x)
            assert set(zip(scans.tolist(), x.tolist(), strict=True)) == expected[part]
            assert len(scans) == len(expected[part])


def canonical(scans):
    """Scans whose empty rows are the table's."""
    rows = [scans >> 6 * row & 63 for row in range(4)]
    return sum((span if span & 7 <= span >> 3 else 1) << 6 * row for row, span in enumerate(rows))


def test_all_other_words_stay_as_they_are():
    rng = np.random.default_rng(2)
    words = mixed_words(FULL, rng, 4000)
    plain = words[(words >> np.uint64(20)) % np.uint64(32) != 0b00010]
    for config in SHAPED:
        assert np.array_equal(expand(plain, config).words, plain)
    fractions = words | np.uint64(1)
    assert np.array_equal(expand(fractions, FULL).words, fractions)
    assert np.array_equal(expand(words, PAPER).words, words)


def test_no_entry_of_the_table_looks_compact():
    """So that a host may send any of them as a plain word."""
    scans = shape_table()[:9, ..., 0].ravel().astype(np.uint64)
    words = scans << np.uint64(FULL.scans.lsb)
    assert np.array_equal(expand(words, FULL).words, words)
    fields = golden.decode(words)
    assert not fields["raised"].any() and not fields["shifted"].any()


def test_sizes_that_a_rom_does_not_hold_draw_nothing():
    sizes = np.arange(32)
    for config, largest in ((SMALL, 8), (FULL, 16)):
        words = compact_words(config, sizes, 32, 32, 1)
        assert set(expand(words, config).origins.tolist()) == set(range(largest + 1))


def test_a_fraction_right_of_every_image_is_left_out():
    words = compact_words(FULL, 16, 32, 32, 1, rest=np.array([503, 504, 511]) << FULL.x.lsb)
    _, origins = expand(words, FULL)
    assert origins.tolist() == [0, 0, 1, 2]


def test_golden_draws_what_the_expanded_frame_draws():
    rng = np.random.default_rng(3)
    words = np.append(mixed_words(FULL, rng, 3000), np.uint64(end_word(FULL)))
    words[: len(words) - 1] &= ~np.uint64(1 << FULL.control_end.lsb)
    table = rng.integers(0, 64, (128, 3))
    frame = Frame(words, Tables(rng.integers(0, 999, 3), table, table), 300, 200, FULL)
    expanded = expand_frame(frame)
    assert len(expanded.codewords) != len(words)
    plain = Frame(expanded.codewords, frame.tables, 300, 200, PAPER)
    found, expected = golden.render(frame), golden.render(plain)
    assert np.array_equal(found.depth, expected.depth)
    assert np.array_equal(found.colour, expected.colour)
    assert expand_frame(plain) is plain
