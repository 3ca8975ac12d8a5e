"""Messages of a page: each becomes an event, or an error of one line."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.camera import Camera
from splatline.view.events import _KINDS, _SETTINGS, Event, check_event
from splatline.view.server.protocol import MOST_BYTES, read_message
from splatline.view.steering import FARTHEST, NEAREST, steer

HOME = Camera((5e5, -3.0, 1e-3), 25.0, 30.0, 20.0, "z", 35.0)

ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=20)
    | st.sampled_from(["rgb24", "paper", "#00ff7F", "png", "engine", 10**400]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=6,
)

NAMES = st.sampled_from([*_KINDS, "set", "", "close"])

MESSAGES = st.fixed_dictionaries(
    {"type": NAMES},
    optional={
        **{key: ANYTHING for values in _KINDS.values() for key in values},
        "name": st.sampled_from(list(_SETTINGS)) | ANYTHING,
        "value": ANYTHING,
    },
)

FINITE = st.floats(-1e5, 1e5)

MOVES = st.one_of(
    st.builds(lambda x, y: {"type": "turn", "dx": x, "dy": y}, FINITE, FINITE),
    st.builds(lambda x, y: {"type": "pan", "dx": x, "dy": y}, FINITE, FINITE),
    st.builds(
        lambda f, x, y: {"type": "zoom", "factor": f, "x": x, "y": y},
        st.floats(0.1, 10.0),
        FINITE,
        FINITE,
    ),
    st.builds(
        lambda a, e: {"type": "orbit", "azimuth": a, "elevation": e},
        st.floats(-720.0, 720.0),
        st.floats(-90.0, 90.0),
    ),
    st.builds(
        lambda target, distance, a, e: {
            "type": "camera",
            "target": target,
            "distance": distance,
            "azimuth": a,
            "elevation": e,
        },
        st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3),
        st.floats(1e-300, 1e300),
        st.floats(-720.0, 720.0),
        st.floats(-90.0, 90.0),
    ),
    st.builds(lambda x, y: {"type": "look", "x": x, "y": y}, FINITE, FINITE),
    st.just({"type": "reset"}),
)


@given(MESSAGES | ANYTHING)
@settings(max_examples=300)
def test_any_message_is_an_event_or_an_error_of_one_line(message):
    try:
        event = check_event(message)
    except InputError as error:
        assert "\n" not in str(error)
        assert len(str(error)) < 300
    else:
        assert isinstance(event, Event)


@given(st.text(max_size=300) | st.binary(max_size=100).map(lambda data: data.decode("latin-1")))
@settings(max_examples=200)
def test_any_text_is_an_event_or_an_error_of_one_line(text):
    try:
        read_message(text)
    except InputError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize(
    "text",
    [
        "[" * 4000,
        '{"type":"turn","dx":NaN,"dy":0}',
        '{"type":"turn","dx":Infinity,"dy":0}',
        '{"type":"turn","dx":' + "9" * 3000 + ',"dy":0}',
        '{"type":"turn","dx":1e400,"dy":0}',
        '{"type":"turn","dx":true,"dy":0}',
        '{"type":"resize","width":15,"height":100}',
        '{"type":"resize","width":100,"height":4097}',
        '{"type":"resize","width":100.5,"height":100}',
        '{"type":"zoom","factor":0.09,"x":0,"y":0}',
        '{"type":"zoom","factor":10.1,"x":0,"y":0}',
        '{"type":"set","name":"background","value":"#12345g"}',
        '{"type":"set","name":"preset","value":"lines8"}',
        '{"type":"set","name":"samples","value":3}',
        '{"type":"set","name":"samples","value":4.0}',
        '{"type":"set","name":"colour","value":{"by":"x","range":[2,1]}}',
        '{"type":"set","name":"split","value":{"left":"paper"}}',
        '{"type":"save","what":"../../etc/passwd"}',
        '{"type":"\\u2028' + "x" * 500 + '"}',
        " " * (MOST_BYTES + 1),
        "",
        "null",
    ],
)
def test_a_bad_message_is_an_error_of_one_line(text):
    with pytest.raises(InputError) as caught:
        read_message(text)
    assert "\n" not in str(caught.value)


def test_the_longest_message_is_read():
    text = json.dumps({"type": "reset", "rest": ""})
    assert read_message(text + " " * (MOST_BYTES - len(text))).kind == "reset"
    with pytest.raises(InputError, match="4096 bytes"):
        read_message(json.dumps({"type": "reset", "rest": "é" * 2100}, ensure_ascii=False))


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("background", "#Ff8000", (1.0, 128 / 255, 0.0)),
        ("colour", {"by": "default"}, None),
        ("colour", {"by": "height"}, ColourBy("height")),
        (
            "colour",
            {"by": "intensity", "map": "magma", "range": [0, 9.5]},
            ColourBy("intensity", "magma", (0.0, 9.5)),
        ),
        ("split", None, None),
        ("split", {"left": "paper", "right": "reference"}, ("paper", "reference")),
        ("samples", 16, 16),
    ],
)
def test_settings_become_values(name, value, expected):
    event = check_event({"type": "set", "name": name, "value": value})
    assert event.values == {"name": name, "value": expected}


@given(st.lists(MOVES, max_size=40))
@settings(max_examples=200)
def test_no_moves_lose_the_camera(moves):
    """Whatever comes, the camera is finite and near, and its rounding is."""
    camera = HOME
    for message in moves:
        camera = steer(check_event(message), camera, HOME, (640, 480), None)
        for each in (camera, camera.rounded()):
            numbers = (*each.target, each.distance, *each.orbit)
            assert all(math.isfinite(number) for number in numbers)
            assert abs(each.elevation) <= 90.0
            assert -180.0 <= each.azimuth <= 180.0
            assert 0.99 * NEAREST <= each.distance / HOME.distance <= 1.01 * FARTHEST
            assert all(
                abs(value - middle) <= 1.01 * FARTHEST * HOME.distance
                for value, middle in zip(each.target, HOME.target, strict=True)
            )


@given(st.lists(MOVES, max_size=10))
def test_a_rounded_camera_differs_by_a_small_part_of_a_pixel(moves):
    camera = HOME
    for message in moves:
        camera = steer(check_event(message), camera, HOME, (640, 480), None)
    rounded = camera.rounded()
    assert rounded.rounded() == rounded
    assert math.dist(rounded.target, camera.target) <= 1e-5 * camera.distance + 1e-9
    assert rounded.distance == pytest.approx(camera.distance, rel=1e-8)
    turned = (rounded.azimuth - camera.azimuth + 180.0) % 360.0 - 180.0
    assert abs(turned) <= 0.00501
    assert abs(rounded.elevation - camera.elevation) <= 0.00501
