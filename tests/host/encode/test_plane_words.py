"""The plane of a word against its definition in exact arithmetic."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from splatline.contract.presets import PLANE
from splatline.host.encode.plane_words import layout_of, plane_bits
from tests.support import plane_words as pw
from tests.support.codewords import bits

STEEPEST = 63 * 4  # levels a pixel, of the coarsest scale
TIE = Fraction(1, 10**6)
FURTHEST = 4095  # the background's

config = pytest.mark.parametrize("config", pw.CONFIGS, ids=lambda config: config.name)
any_float = st.floats(width=64)
slope = st.floats(-1.5 * STEEPEST, 1.5 * STEEPEST) | st.floats(-2.0, 2.0)
depths = st.floats(-100.0, 4200.0) | st.sampled_from([0.0, 4094.0])
places = st.floats(0.0, 7.0)
many = settings(max_examples=400, deadline=None, derandomize=True, database=None)


def fields_of(depth, change_x, change_y, right, down, config=PLANE):
    """The plane as a word has it: slopes and Z as integers, and the shift."""
    high = plane_bits(depth, change_x, change_y, right, down, layout_of(config))
    word = int(high) << 64
    assert 0 <= word < 1 << 96
    found = {name: bits(word, *pw.widths(config)[name]) for name in ("a", "b", "scale", "z")}
    half = 1 << config.slope_bits - 1
    a, b = ((found[name] ^ half) - half for name in ("a", "b"))
    return a, b, found["scale"], found["z"], word


def rounded(value):
    return math.floor(value + Fraction(1, 2))


def is_tie(value):
    return abs(value - rounded(value)) > Fraction(1, 2) - TIE


def exactly(depth, change_x, change_y, right, down):
    """Slopes, scale, Z before it is cut off, and whether one lies on the border of two values."""
    steepest = 4 * max(abs(change_x), abs(change_y))
    scale = next((k for k in range(3) if steepest < Fraction(127, 2) * (1, 2, 4)[k]), 3)
    step = Fraction((1, 2, 4, 16)[scale], 4)
    cut = min(Fraction(63) * step / max(steepest / 4, TIE), 1)
    a, b = change_x * cut / step, change_y * cut / step
    ties = is_tie(a) or is_tie(b)
    a, b = rounded(a), rounded(b)
    z = 2 * (depth - (a * right + b * down) * step) + 1
    return a, b, scale, z, ties or is_tie(z)


@many
@given(depths, slope, slope, places, places)
@example(0.0, 15.875, 0.0, 0.5, 0.5)
@example(100.0, math.nextafter(15.875, 0), -15.875, 0.5, 0.5)
def test_a_word_holds_the_plane_rounded_to_nearest(depth, change_x, change_y, right, down):
    a, b, scale, z, tie = exactly(*map(Fraction, (depth, change_x, change_y, right, down)))
    found = fields_of(depth, change_x, change_y, right, down)
    if not tie and 0 <= z <= 8191:
        assert found[:4] == (a, b, scale, rounded(z))


@many
@given(st.floats(0.0, 4094.0), any_float, any_float, places, places)
@example(4000.0, -100.0, 0.0, 4.0, 2.0)
@example(50.0, 100.0, 0.0, 4.0, 2.0)
@example(0.0, 252.0, 252.0, 7.0, 7.0)
@example(4094.0, -252.0, -252.0, 7.0, 7.0)
def test_the_plane_goes_through_its_point_even_where_z_ends(depth, change_x, change_y, right, down):
    a, b, scale, z, _ = fields_of(depth, change_x, change_y, right, down)
    step = Fraction((1, 2, 4, 16)[scale], 4)
    there = Fraction(z, 2) - Fraction(1, 2)
    there += (a * Fraction(right) + b * Fraction(down)) * step
    # Half a unit of Z, and where Z was cut off half a step of either slope.
    most = Fraction(1, 4) + TIE
    if z in (0, 8191):
        most += step / 2 * (Fraction(right) + Fraction(down))
    assert abs(there - Fraction(depth)) <= most


@many
@given(st.floats(300, 1e299), st.floats(-1.0, 1.0))
def test_a_plane_that_is_too_steep_leans_the_same_way(steep, share):
    # An edge-on disc covers pixels along the line on which its depth does not change.
    a, b, scale, *_ = fields_of(2000.0, steep, share * steep, 0.5, 0.5)
    assert (a, scale) == (63, 3)
    assert abs(b - 63 * share) <= 0.5 + 1e-9
    a, b, scale, *_ = fields_of(2000.0, share * steep, -steep, 0.5, 0.5)
    assert (b, scale) == (-63, 3)
    assert abs(a - 63 * share) <= 0.5 + 1e-9


@config
@many
@given(any_float, any_float, any_float, places, places)
def test_no_float_wraps_a_field(config, depth, change_x, change_y, right, down):
    most = (1 << config.slope_bits - 1) - 1
    a, b, _, z, word = fields_of(depth, change_x, change_y, right, down, config)
    assert max(abs(a), abs(b)) <= most
    assert word >> pw.widths(config)["z"][0] == z  # nothing above it
    for rising, slope in ((change_x, a), (change_y, b)):
        assert slope == 0 or (slope > 0) == (rising > 0)


SPECIAL = [0.0, -0.0, 5e-324, 1e-300, 1.0, 1e9, 1e300, 1.7e308, math.inf, math.nan]


def test_special_floats_saturate_as_their_limits_do():
    values = [sign * value for value in SPECIAL for sign in (1.0, -1.0)]
    rng = np.random.default_rng(1)
    for depth, change_x, change_y in rng.choice(values, (2000, 3)):
        *_, word = fields_of(depth, change_x, change_y, 0.5, 0.5)
        drawn = pw.depth_at(word, 0, 0)
        if math.isnan(depth) or depth < -1e6:
            assert drawn <= 252
        elif depth > 1e6:
            assert drawn >= 4094 - 252
        else:
            assert drawn in range(254)


def test_flat_planes_have_the_depth_that_is_nearest():
    for depth in np.random.default_rng(2).uniform(-3.0, 4098.0, 3000):
        *_, word = fields_of(depth, 0.0, 0.0, 3.0, 1.0)
        drawn = {pw.depth_at(word, row, column) for row in range(8) for column in range(8)}
        (level,) = drawn
        assert abs(level - min(max(depth, 0.0), FURTHEST)) <= 0.75
