import numpy as np
import pytest

from splatline.contract.raster import Raster
from tests.support import codewords as cw


def random_raster(config, seed=3):
    rng = np.random.default_rng(seed)
    depth = rng.integers(0, config.background_depth, (5, 7)).astype(np.uint16)
    colour = rng.integers(0, config.channel_max + 1, (5, 7, 3)).astype(np.uint8)
    return Raster(depth, colour, config)


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_background_is_drawn_nowhere(config):
    raster = Raster.background(7, 5, config)
    assert raster.depth.shape == (5, 7)
    assert not raster.drawn.any()
    assert not raster.colour.any()
    assert raster.to_rgb((0.25, 0.5, 1.0)).reshape(-1, 3).tolist() == [[0.25, 0.5, 1.0]] * 35


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_the_levels_span_0_to_1(config):
    raster = Raster.background(2, 1, config)
    raster.depth[0, 1] = 0
    raster.colour[0, 1] = [0, 1, config.channel_max]
    assert raster.to_rgb()[0, 1].tolist() == [0.0, 1 / config.channel_max, 1.0]
    assert raster.drawn.tolist() == [[False, True]]


@pytest.mark.parametrize("config", cw.CONFIGS, ids=lambda config: config.name)
def test_colours_survive_being_stored_as_words(config):
    raster = random_raster(config)
    back = Raster.from_words(raster.depth, raster.colour_words, config)
    assert back.mismatches(raster) == 0
    assert back.depth is not raster.depth


def test_a_stored_colour_has_red_lowest_and_blue_highest():
    raster = Raster.background(1, 1)
    raster.colour[0, 0] = [1, 2, 4]
    assert raster.colour_words.tolist() == [[0b100_010_001]]


def test_a_pixel_counts_once_whatever_differs_in_it():
    raster = random_raster(cw.PAPER)
    other = Raster(raster.depth.copy(), raster.colour.copy())
    assert raster.mismatches(other) == 0
    other.depth[0, 0] ^= 1
    other.colour[0, 0] ^= 1
    other.colour[4, 6, 2] ^= 1
    other.depth[1, 2] ^= 1
    assert raster.mismatches(other) == 3
    assert np.argwhere(raster.differs(other)).tolist() == [[0, 0], [1, 2], [4, 6]]


@pytest.mark.parametrize(
    ("other", "message"),
    [(Raster.background(6, 5), "pixels"), (Raster.background(7, 5, cw.DEEP), "configurations")],
)
def test_rasters_of_two_kinds_do_not_compare(other, message):
    with pytest.raises(ValueError, match=message):
        random_raster(cw.PAPER).mismatches(other)


def test_a_part_has_some_lines_and_columns():
    depth = np.arange(12, dtype=np.uint16).reshape(3, 4)
    raster = Raster(depth, np.zeros((3, 4, 3), np.uint8))
    assert raster.part(slice(2, 3), slice(1, None)).depth.tolist() == [[9, 10, 11]]
    assert raster.part(slice(None), slice(None)).depth.tolist() == raster.depth.tolist()
    assert raster.part(slice(1, None), slice(3, None)).colour.shape == (2, 1, 3)
