"""The mean of rasters."""

import numpy as np
import pytest

from splatline.contract.presets import PAPER
from splatline.contract.raster import Raster
from splatline.sim.golden.multisample import Average, average, mismatches

BACKGROUND = (0.25, 0.5, 1.0)


def rasters(*pixels):
    """One raster of 1 x n pixels a sample, each pixel (depth, level) or None."""
    found = []
    for row in pixels:
        raster = Raster.background(len(row), 1, PAPER)
        for column, pixel in enumerate(row):
            if pixel is not None:
                raster.depth[0, column], raster.colour[0, column] = pixel
        found.append(raster)
    return found


def test_colours_are_the_mean_of_the_samples_background_included():
    picture = average(rasters([(3, 7), (5, 2), None], [(4, 5), None, None]))
    rgb = picture.to_rgb(BACKGROUND)[0]
    assert rgb[0] == pytest.approx([6 / 7] * 3)
    assert rgb[1] == pytest.approx((2 / 7 + np.array(BACKGROUND)) / 2)
    assert rgb[2] == pytest.approx(BACKGROUND)


def test_depth_is_the_mean_of_what_was_drawn_where_that_is_half_of_the_samples():
    picture = average(
        rasters(
            [(3, 0), (9, 0), None, (1, 0)],
            [(4, 0), None, None, None],
            [(8, 0), (12, 0), (7, 0), None],
        )
    )
    assert isinstance(picture, Average)
    assert picture.coverage[0] == pytest.approx([1, 2 / 3, 1 / 3, 1 / 3])
    assert picture.drawn.tolist() == [[True, True, False, False]]
    # 9 and 12 are 10.5 in the mean: to the even one.
    assert picture.depth.tolist() == [[5, 10, 511, 511]]
    assert picture.config is PAPER


def test_a_single_raster_stays_what_it_is():
    (raster,) = rasters([(3, 7), None])
    assert average([raster]) is raster
    alone = Average((raster,))
    assert np.array_equal(alone.depth, raster.depth)
    assert np.array_equal(alone.drawn, raster.drawn)
    assert np.array_equal(alone.to_rgb(BACKGROUND), raster.to_rgb(BACKGROUND))


def test_a_pixel_differs_where_any_of_its_samples_does():
    one = average(rasters([(3, 7), (4, 4), None], [(3, 7), (4, 4), None]))
    assert mismatches(one, one) == 0
    other = average(rasters([(3, 7), (4, 4), None], [(3, 6), (4, 4), (1, 1)]))
    assert mismatches(one, other) == 2
    # The same mean, but not the same samples.
    crossed = average(rasters([(2, 7), (4, 4), None], [(4, 7), (4, 4), None]))
    assert np.array_equal(one.depth, crossed.depth)
    assert mismatches(one, crossed) == 1
    with pytest.raises(ValueError, match="shorter"):
        mismatches(one, average(rasters([(3, 7), (4, 4), None])))
