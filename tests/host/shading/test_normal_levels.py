"""Levels of slopes."""

import numpy as np
import pytest

from splatline.host.shading.normal_levels import LEVELS, level_slopes, quantise_slopes


@pytest.mark.parametrize("levels", [8, LEVELS])
def test_the_slope_of_a_level_has_that_level(levels):
    slopes = level_slopes(levels)
    assert slopes[-1] == levels - 1
    for level, slope in enumerate(slopes):
        assert quantise_slopes(slope, -slope, levels) == (level, levels - 1 - level)


@pytest.mark.parametrize("angle", [0.0, 10.0, 100.0, 170.0, 190.0, 350.0])
@pytest.mark.parametrize("steep", [10.0, 63.0, 1e3, 1e6])
def test_a_disc_seen_edge_on_keeps_its_direction(angle, steep):
    slope = steep * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    x, y = (level_slopes()[level] for level in quantise_slopes(*slope, LEVELS))
    assert abs((np.degrees(np.arctan2(y, x)) - angle + 180.0) % 360.0 - 180.0) < 3.0
