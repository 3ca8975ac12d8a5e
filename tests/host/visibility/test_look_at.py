"""A view that looks at a point from a distance."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.host.visibility.look_at import NEAR, look_at
from splatline.host.visibility.view import UP_AXES, orbit_axes

PLACES = st.tuples(*(st.floats(-1e6, 1e6) for _ in range(3)))


@given(
    PLACES,
    st.floats(1e-3, 1e6),
    st.tuples(st.floats(-180.0, 180.0), st.floats(-90.0, 90.0)),
    st.sampled_from(list(UP_AXES)),
)
def test_the_axis_meets_the_target_at_the_distance(target, distance, orbit, up):
    view = look_at(target, distance, orbit=orbit, up=up)
    seen = view.axes @ (np.asarray(target) - view.eye)
    error = 1e-9 * max(1.0, *map(abs, target), distance)
    assert seen == pytest.approx([0.0, 0.0, distance], abs=error)
    assert np.array_equal(view.axes, orbit_axes(orbit, up))
    assert view.near == NEAR * distance


@pytest.mark.parametrize(("zoom", "half"), [(1.0, 1.0), (2.0, 0.5)])
def test_the_field_of_view_spans_the_shorter_side(zoom, half):
    """At a right angle half the shorter side is as long as the distance."""
    view = look_at((0, 0, 0), 1.0, fov=90.0, size=(400, 300), zoom=zoom)
    assert view.focal * half == pytest.approx(150.0)
    assert view.middle == (200.0, 150.0)


@pytest.mark.parametrize(
    ("target", "distance", "options"),
    [
        ((0, 0), 1.0, {}),
        ((0, 0, math.nan), 1.0, {}),
        ((0, 0, 0), 0.0, {}),
        ((0, 0, 0), -1.0, {}),
        ((0, 0, 0), math.inf, {}),
        ((0, 0, 0), 1.0, {"fov": 180.0}),
        ((0, 0, 0), 1.0, {"up": "w"}),
        ((0, 0, 0), 1.0, {"size": (0, 5)}),
    ],
)
def test_a_value_out_of_range_is_an_error_of_one_line(target, distance, options):
    with pytest.raises(InputError) as caught:
        look_at(target, distance, **options)
    assert "\n" not in str(caught.value)
