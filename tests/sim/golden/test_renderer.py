import numba
import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.contract.frame import Frame, Tables
from splatline.contract.presets import PAPER, RGB24
from splatline.contract.raster import Raster
from splatline.sim import golden
from tests.support import codewords as cw

SIZES = [(40, 24), (37, 5), (1, 1), (3, 40), (64, 2)]


def assert_same(raster, expected):
    np.testing.assert_array_equal(raster.depth, expected.depth)
    np.testing.assert_array_equal(raster.colour, expected.colour)
    assert raster.config == expected.config
    assert (raster.depth.dtype, raster.colour.dtype) == (np.uint16, np.uint8)


def drawn(words, size=(32, 16)):
    """The pixels that code words draw, as a set of (line, column)."""
    raster = golden.render(cw.make_frame([*words, cw.end()], size))
    return {(int(line), int(column)) for line, column in np.argwhere(raster.drawn)}


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("size", SIZES)
def test_random_words_draw_what_the_contract_says(size, config):
    rng = np.random.default_rng([*size, config.x_bits])
    frame = cw.random_frame(rng, 400, size, config)
    raster = golden.render(frame)
    assert raster.drawn.any()
    assert_same(raster, cw.draw(frame))


def test_the_widest_and_highest_image_has_its_borders_where_they_are():
    rng = np.random.default_rng(5)
    words = []
    for _ in range(300):
        rows = rng.integers(0, 8, (4, 2)).tolist()
        words.append(
            cw.encode(rows, mode=int(rng.integers(2)), d=int(rng.integers(128)),
                      x=int(rng.choice([0, 1, 500, 504, 505, 508, 510, 511])),
                      z=int(rng.integers(512)))
        )  # fmt: skip
        words.append(cw.advance(int(rng.integers(0, 8))))
    words.append(cw.end())
    frame = cw.make_frame(words, (512, 1024))
    assert_same(golden.render(frame), cw.draw(frame))


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_any_bits_at_all_are_safe(config):
    rng = np.random.default_rng(8)
    words = rng.integers(0, 1 << 64, 2000, dtype=np.uint64)
    # Rows whose last column is 0 are mostly empty: more control words than chance has.
    words[rng.random(2000) < 0.1] &= ~np.uint64(0o70707070 << 1)
    frame = cw.make_frame([*words.tolist(), cw.end(config)], (50, 30), config=config)
    assert_same(golden.render(frame), cw.draw(frame))


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_the_largest_numbers_do_not_overflow(config):
    last = (1 << 64) - 1
    fields = {name: (1 << width) - 1 for name, width in cw.widths(config).items()}
    fields |= {"x": 0, "z": fields["z"] - 1}
    words = [
        last,
        cw.advance((1 << config.x_bits) - 1, config),
        last,
        cw.end(config),
    ]
    first = cw.encode(cw.EVERYTHING, config=config, **fields)
    frame = cw.make_frame([first, *words], (16, 8), cw.largest_tables(config), config)
    assert_same(golden.render(frame), cw.draw(frame))
    assert golden.render(frame).colour[0, 0].tolist() == [config.channel_max] * 3
    # The sums themselves, where nothing saturates: as wide a channel as there is.
    sums = {"channel_bits": 8, "colour_shift": config.coefficient_bits}
    wide = config.replace(**sums)
    frame = cw.make_frame([first, *words], (16, 8), cw.largest_tables(wide), wide)
    assert_same(golden.render(frame), cw.draw(frame))


def test_the_line_may_grow_without_end():
    words = [*[cw.advance(511)] * 5000, cw.encode(cw.EVERYTHING), cw.end()]
    assert not golden.render(cw.make_frame(words, (8, 1024))).drawn.any()


@pytest.fixture
def threads():
    """Set the number of threads; what it was before comes back."""
    before = numba.get_num_threads()
    yield numba.set_num_threads
    numba.set_num_threads(before)


def spread(rng, size, config=PAPER):
    """A frame with a few elements on every line and a start to draw over."""
    words = []
    for _ in range(size[1] + 6):
        chosen = cw.random_frame(rng, 12, size, config).codewords[:-1].tolist()
        words += [*(word for word in chosen if not cw.is_control(word)), cw.advance(1, config)]
    words.append(cw.end(config))
    return cw.make_frame(words, size, cw.random_tables(rng, config), config)


@pytest.mark.parametrize("size", [(40, 61), (9, 7), (5, 1)])
def test_the_picture_is_the_same_however_it_is_cut(size, threads):
    rng = np.random.default_rng([3, *size])
    frame = spread(rng, size, RGB24)
    initial = cw.draw(cw.random_frame(rng, 200, size, frame.config))
    expected = cw.draw(frame, initial)
    for count in range(1, min(2, numba.config.NUMBA_NUM_THREADS) + 1):
        threads(count)
        assert_same(golden.render(frame, initial), expected)
        for bands in (1, 2, 3, 7, 61, 200):
            assert_same(golden.render(frame, initial, bands=bands), expected)


def test_bands_may_be_cut_where_all_elements_are():
    rng = np.random.default_rng(12)
    words = [word for word in cw.random_frame(rng, 900, (30, 1)).codewords.tolist()
             if not cw.is_control(word)]  # fmt: skip
    frame = cw.make_frame([cw.advance(20), *words, cw.end()], (30, 40))
    expected = cw.draw(frame)
    for bands in range(1, 41):
        assert_same(golden.render(frame, bands=bands), expected)


@pytest.mark.parametrize("bands", [0, -1])
def test_there_is_at_least_one_band(bands):
    with pytest.raises(ValueError, match="band"):
        golden.render(cw.make_frame([cw.end()], (8, 8)), bands=bands)


def test_a_symmetric_word_has_its_half_turn_below():
    rows = [(1, 0), (1, 0), (2, 2), (1, 3)]
    assert drawn([cw.advance(6), cw.encode(rows, x=10)]) == {
        (4, 12), (5, 11), (5, 12), (5, 13),
        (6, 14), (6, 15), (6, 16), (7, 15),
    }  # fmt: skip


def test_the_middle_of_a_symmetric_word_may_lie_half_a_line_higher():
    """Row 3 with its ends exchanged is the middle: here a diamond, and one that is not as wide."""
    rows = [(1, 0), (4, 4), (3, 5), (6, 2)]  # 2 + 6 is even: about column 4
    assert drawn([cw.advance(6), cw.encode(rows, x=10)]) == {
        (3, 14), (4, 13), (4, 14), (4, 15),
        *((5, 12 + n) for n in range(5)),
        (6, 13), (6, 14), (6, 15), (7, 14),
    }  # fmt: skip
    rows = [(1, 0), (3, 3), (3, 5), (5, 2)]  # odd: about the border of columns 3 and 4
    assert drawn([cw.advance(6), cw.encode(rows, x=10)]) == {
        (3, 13), (4, 13), (4, 14), (4, 15),
        *((5, 12 + n) for n in range(4)),
        (6, 12), (6, 13), (6, 14), (7, 14),
    }  # fmt: skip


def test_the_middle_of_a_symmetric_word_may_lie_half_a_column_further_right():
    """As an empty first row says whose first column has the bit 1."""
    for code in [(first, last) for first in (2, 3, 6, 7) for last in range(first)]:
        rows = [code, (1, 0), (0, 0), (3, 5)]
        assert drawn([cw.advance(4), cw.encode(rows, x=3)]) == {
            (2, 3), (3, 6), (3, 7), (3, 8),
            (4, 6), (4, 7), (4, 8), (5, 11),
        }  # fmt: skip


def test_a_fraction_has_four_rows_alone():
    rows = [(0, 0), (7, 0), (2, 2), (6, 7)]
    assert drawn([cw.advance(4), cw.encode(rows, mode=1, x=3)]) == {(0, 3), (2, 5), (3, 9), (3, 10)}


@pytest.mark.parametrize(("lines", "left"), [(0, 4), (1, 5), (4, 8), (12, 8), (15, 5), (19, 1)])
def test_blocks_are_cut_at_the_top_and_at_the_bottom(lines, left):
    pixels = drawn([cw.advance(lines), cw.encode(cw.EVERYTHING, x=8)])
    assert pixels == {
        (line, column)
        for line in range(lines - 4, lines + 4)
        for column in range(8, 16)
        if 0 <= line < 16
    }
    assert len(pixels) == 8 * left


@pytest.mark.parametrize("x", [24, 25, 31, 32, 33, 511])
def test_blocks_are_cut_at_the_right(x):
    pixels = drawn([cw.advance(8), cw.encode(cw.EVERYTHING, x=x)])
    assert len(pixels) == 8 * min(8, max(0, 32 - x))
    assert all(column >= x for _, column in pixels)


def test_a_control_word_advances_by_all_of_x():
    words = [cw.advance(511), cw.advance(256), cw.encode(cw.EVERYTHING)]
    pixels = drawn(words, size=(8, 1024))
    assert {line for line, _ in pixels} == set(range(763, 771))


def test_lines_past_the_image_are_drawn_nowhere():
    words = [cw.advance(511)] * 40 + [cw.encode(cw.EVERYTHING)]
    assert not drawn(words)


def test_of_equal_depths_the_first_stays_and_a_nearer_one_replaces_it():
    tables = Tables(
        np.zeros(3, np.int64), np.full((128, 3), 63, np.int64), np.zeros((128, 3), np.int64)
    )
    words = [cw.encode([(0, 2), *cw.NOTHING[1:]], mode=1, d=127, z=9),
             cw.encode([(1, 2), *cw.NOTHING[1:]], mode=1, d=64, z=9),
             cw.encode([(2, 2), *cw.NOTHING[1:]], mode=1, d=32, z=8)]  # fmt: skip
    raster = golden.render(cw.make_frame([cw.advance(4), *words, cw.end()], (4, 1), tables))
    assert raster.depth.tolist() == [[9, 9, 8, 511]]
    assert raster.colour[0, :, 0].tolist() == [7, 7, 63 * 32 >> 10, 0]


def test_the_background_depth_is_never_drawn():
    assert not drawn([cw.advance(8), cw.encode(cw.EVERYTHING, d=127, z=511)])
    assert len(drawn([cw.advance(8), cw.encode(cw.EVERYTHING, z=510)])) == 64


def test_colour_saturates_and_drops_its_fraction():
    ambient = np.array([16383, 1023, 1024])
    kd = np.zeros((128, 3), np.int64)
    ks = np.zeros((128, 3), np.int64)
    kd[127], ks[127] = 63, 63
    kd[5], ks[5] = [0, 0, 1], [0, 1, 0]
    one = [(0, 0), *cw.NOTHING[1:]]
    words = [cw.encode(one, mode=1, x=0, m=127, d=127, s=127),
             cw.encode(one, mode=1, x=1, m=5, d=0, s=0),
             cw.encode(one, mode=1, x=2, m=5, d=0, s=1),
             cw.encode(one, mode=1, x=3, m=5, d=127, s=0)]  # fmt: skip
    frame = cw.make_frame([cw.advance(4), *words, cw.end()], (4, 1), Tables(ambient, kd, ks))
    assert golden.render(frame).colour.tolist() == [[[7, 7, 7], [7, 0, 1], [7, 1, 1], [7, 0, 1]]]


def test_an_empty_symmetric_word_is_no_control_word():
    word = cw.encode([(1, 0)] * 4, mode=0, d=1, x=9)
    rows = [(0, 0), (7, 0), (7, 0), (7, 0)]
    assert drawn([cw.advance(4), word, cw.encode(rows, mode=1)]) == {(0, 0)}


def test_words_after_the_end_are_ignored():
    shape = cw.encode(cw.EVERYTHING, z=1)
    frame = cw.make_frame([shape, cw.end(), cw.encode(cw.EVERYTHING), cw.end()], (16, 8))
    short = cw.make_frame([shape, cw.end()], (16, 8))
    assert golden.render(frame).mismatches(golden.render(short)) == 0


@pytest.mark.parametrize("words", [[], [cw.encode(cw.EVERYTHING)], [cw.advance(3)]])
def test_a_stream_without_an_end_is_cut_short(words):
    with pytest.raises(InputError, match="no end-of-frame word"):
        golden.render(cw.make_frame(words, (8, 8)))


def test_an_empty_frame_is_background():
    raster = golden.render(cw.make_frame([cw.end()], (9, 7)))
    assert_same(raster, Raster.background(9, 7))


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_a_chain_of_two_engines_draws_what_one_draws(config):
    rng = np.random.default_rng(31)
    size = (30, 20)
    frame = cw.random_frame(rng, 300, size, config)
    initial = cw.draw(cw.random_frame(rng, 300, size, config))
    before = initial.depth.copy(), initial.colour.copy()
    assert_same(golden.render(frame, initial), cw.draw(frame, initial))
    np.testing.assert_array_equal(initial.depth, before[0])
    np.testing.assert_array_equal(initial.colour, before[1])


def spoilt(**changes):
    """An initial raster with one thing wrong."""
    depth = np.full((8, 8), 5, np.uint16)
    colour = np.zeros((8, 8, 3), np.uint8)
    for name, value in changes.items():
        {"depth": depth, "colour": colour}[name][2, 3] = value
    return Raster(depth, colour)


@pytest.mark.parametrize(
    ("initial", "message"),
    [
        (Raster.background(9, 8), "9x8"),
        (Raster.background(8, 8, cw.DEEP), "configuration"),
        (spoilt(depth=512), "no pixel holds"),
        (spoilt(colour=8), "no pixel holds"),
    ],
)
def test_a_bad_initial_raster_is_refused(initial, message):
    with pytest.raises(ValueError, match=message):
        golden.render(cw.make_frame([cw.end()], (8, 8)), initial)


def test_a_colour_at_background_depth_of_an_initial_raster_does_not_count():
    picture = golden.render(cw.make_frame([cw.end()], (8, 8)), spoilt(depth=511, colour=1))
    assert not picture.drawn[2, 3]
    assert not picture.colour[2, 3].any()


@pytest.mark.parametrize("size", [(0, 4), (4, 0), (513, 4), (4, 1025)])
def test_an_image_that_does_not_fit_is_refused(size):
    with pytest.raises(InputError, match=f"{size[0]}x{size[1]}.*512x1024"):
        golden.render(cw.make_frame([cw.end()], size))


@pytest.mark.parametrize(
    ("name", "table", "message"),
    [
        ("ambient", np.zeros(4, np.int64), "shape"),
        ("ambient", np.array([0, 0, 1 << 14]), "14 bits"),
        ("ambient", np.array([0, -1, 0]), "14 bits"),
        ("diffuse", np.zeros((127, 3), np.int64), "shape"),
        ("diffuse", np.full((128, 3), 64), "6 bits"),
        ("specular", np.full((128, 3), 64), "6 bits"),
        ("specular", np.zeros((128, 4), np.int64), "shape"),
    ],
)
def test_tables_that_do_not_fit_are_refused(name, table, message):
    zeros = np.zeros((128, 3), np.int64)
    tables = {"ambient": np.zeros(3, np.int64), "diffuse": zeros, "specular": zeros, name: table}
    frame = Frame(np.array([cw.end()], np.uint64), Tables(**tables), 8, 8)
    with pytest.raises(InputError, match=f"'{name}'.*{message}"):
        golden.render(frame)


def test_decode_finds_the_fields_where_the_contract_has_them():
    word = 1 | 5 << 1 | 6 << 4 | 1 << 19 | 2 << 22 | 99 << 25 | 100 << 32
    word |= 101 << 39 | 300 << 46 | 401 << 55
    (fields,) = golden.decode(np.array([word], np.uint64))
    assert fields["mode"] == 1
    assert fields["first"].tolist() == [5, 0, 0, 1]
    assert fields["last"].tolist() == [6, 0, 0, 2]
    names = ("diffuse", "specular", "material", "x", "z", "control", "end")
    assert [int(fields[name]) for name in names] == [99, 100, 101, 300, 401, 0, 0]


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_decode_tells_control_words_in_every_configuration(config):
    words = [cw.advance(3, config), cw.end(config), cw.encode(cw.NOTHING, d=1, config=config),
             cw.encode([(0, 0), *cw.NOTHING[1:]], mode=1, config=config)]  # fmt: skip
    fields = golden.decode(np.array(words, np.uint64), config)
    assert fields["control"].tolist() == [True, True, False, False]
    assert fields["end"].tolist() == [False, True, False, False]
    assert fields["x"].tolist() == [3, 0, 0, 0]
    every = golden.decode(np.array([2**64 - 1], np.uint64), config)[0]
    assert every["z"] == config.background_depth
    assert every["x"] == config.max_width - 1


def test_decode_of_nothing_is_nothing():
    assert golden.decode(np.zeros(0, np.uint64), PAPER).shape == (0,)


def test_block_rows_are_the_pixels_that_the_contract_says():
    """Of any bits, and of symmetric words whose middle lies half a line or column further."""
    rng = np.random.default_rng(8)
    words = [int(word) for word in rng.integers(0, 1 << 25, 3000)]
    halves = [(6, 1), (5, 1), (7, 2), (4, 3)]
    words += [cw.encode([(2, 5), (1, 6), (0, 7), half]) for half in halves]
    words += [cw.encode([(first, 0), (2, 5), (1, 6), (0, 7)]) for first in range(1, 8)]
    fields = golden.decode(np.array(words, np.uint64))
    assert 0 < fields["raised"].sum() < fields["shifted"].sum() < len(words) / 2
    firsts, lasts = golden.block_rows(fields)
    columns = np.arange(8)
    covered = (firsts[..., None] <= columns) & (columns <= lasts[..., None])
    expected = [
        [[cw.covers(w, row, column) for column in range(8)] for row in range(8)] for w in words
    ]
    assert np.array_equal(covered, expected)
