import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.contract.raster_beats import from_beats, to_beats
from tests.support import codewords as cw

END = 1 << 89


def limbs(*beats):
    """Numbers of up to 128 bits as rows of two limbs."""
    return np.array([[beat & 2**64 - 1, beat >> 64] for beat in beats], np.uint64).reshape(-1, 2)


def beat(line, word, depths=(5, 5, 5, 5), colours=(0, 0, 0, 0)):
    """A beat of the paper's engine, from the contract's widths."""
    number = 0
    for pixel in range(4):
        number |= depths[pixel] << 9 * pixel | colours[pixel] << 36 + 9 * pixel
    return number | word << 72 | line << 79


def random_raster(rng, width, height, config=PAPER, share=0.3):
    depth = rng.integers(0, config.background_depth, (height, width)).astype(np.uint16)
    colour = rng.integers(0, config.channel_max + 1, (height, width, 3)).astype(np.uint8)
    empty = rng.random((height, width)) > share
    depth[empty] = config.background_depth
    colour[empty] = 0
    return Raster(depth, colour, config)


def test_a_beat_has_its_fields_where_the_contract_has_them():
    raster = Raster.background(10, 6)
    raster.depth[3, 5:8] = [1, 2, 510]
    raster.colour[3, 5:8] = [[7, 0, 1], [0, 7, 2], [1, 2, 7]]
    beats = to_beats(raster)
    depths = (511, 1, 2, 510)
    colours = (0, 7 | 1 << 6, 7 << 3 | 2 << 6, 1 | 2 << 3 | 7 << 6)
    np.testing.assert_array_equal(beats, limbs(beat(3, 1, depths, colours), END))


def test_words_come_in_order_and_those_of_background_alone_are_left_out():
    raster = Raster.background(9, 3)
    raster.depth[[0, 0, 2], [8, 1, 4]] = 7
    places = [(int(high >> 15) & 1023, int(high >> 8) & 127) for _, high in to_beats(raster)[:-1]]
    assert places == [(0, 0), (0, 2), (2, 1)]


def test_pixels_beyond_the_last_column_are_background():
    raster = Raster.background(5, 1)
    raster.depth[0, 4] = 3
    expected = limbs(beat(0, 1, (3, 511, 511, 511)), END)
    np.testing.assert_array_equal(to_beats(raster), expected)


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
@pytest.mark.parametrize("size", [(16, 9), (1, 1), (13, 5), (2, 40)])
@pytest.mark.parametrize("share", [0.0, 0.1, 1.0])
def test_a_raster_survives_the_way_there_and_back(size, config, share):
    raster = random_raster(np.random.default_rng(size), *size, config, share)
    beats = to_beats(raster)
    assert beats.dtype == np.uint64
    back = from_beats(beats, *size, config)
    assert back.mismatches(raster) == 0
    assert (back.depth.dtype, back.colour.dtype) == (np.uint16, np.uint8)


def test_the_last_word_of_the_largest_image_fits():
    raster = Raster.background(512, 1024)
    raster.depth[-1, -1] = 0
    assert from_beats(to_beats(raster), 512, 1024).mismatches(raster) == 0


def test_an_end_beat_may_hold_anything_else():
    raster = from_beats(limbs(END | 12345), 8, 4)
    assert not raster.drawn.any()


@pytest.mark.parametrize(
    ("beats", "message"),
    [
        (limbs(), "none of 0 beats"),
        (limbs(beat(0, 0)), "none of 1 beats"),
        (limbs(END, beat(0, 0), END), "beat 0 of 3 ends"),
        (limbs(END, END), "beat 0 of 2 ends"),
        (limbs(beat(4, 0), END), "line 4, outside 10x4"),
        (limbs(beat(0, 3), END), "word 3 of line 0, outside 10x4"),
        (limbs(beat(1, 0), beat(1, 0), END), "beat 1 is word 0 of line 1, after word 0 of line 1"),
        (limbs(beat(1, 1), beat(1, 0), END), "after word 1 of line 1"),
        (limbs(beat(2, 0), beat(1, 2), END), "after word 0 of line 2"),
        (limbs(beat(0, 2), END), "beyond the last column"),
        (limbs(beat(0, 0, (511, 5, 5, 5), (1, 0, 0, 0)), END), "background depth has a colour"),
        (limbs(beat(0, 0) | 1 << 90, END), "above its end bit"),
        (limbs(beat(0, 0), beat(1, 0, (511,) * 4), END), "beat 1 is word 0 of line 1, in which"),
        (np.zeros((3, 1), np.uint64), r"shape \(n, 2\)"),
    ],
)
def test_beats_that_no_engine_may_send_are_refused(beats, message):
    with pytest.raises(ValueError, match=message):
        from_beats(beats, 10, 4)


def test_an_image_that_no_engine_draws_has_no_beats():
    with pytest.raises(ValueError, match="513x1"):
        to_beats(Raster.background(513, 1))
