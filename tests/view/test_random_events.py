"""Whatever a person does, a picture follows."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from splatline.contract.presets import PRESETS
from splatline.view.events import check_event
from splatline.view.live_cloud import live_cloud
from splatline.view.session import QUIET, Session
from tests.support.clouds import sphere
from tests.view.test_events import MOVES
from tests.view.views import Clock, ball, event, pictures, texts


@pytest.fixture(scope="module")
def small():
    return live_cloud(sphere(200))


SIDES = st.integers(16, 60)

MESSAGES = st.one_of(
    MOVES,
    st.builds(lambda w, h: {"type": "resize", "width": w, "height": h}, SIDES, SIDES),
    st.builds(lambda value: {"type": "moving", "value": value}, st.booleans()),
    st.builds(lambda what: {"type": "save", "what": what}, st.sampled_from(["png", "words"])),
    st.just({"type": "command"}),
    st.builds(
        lambda pair: {"type": "set", "name": pair[0], "value": pair[1]},
        st.sampled_from(
            [
                *(("preset", name) for name in PRESETS),
                *(("quality", name) for name in ("paper", "fast", "exact")),
                *(("samples", number) for number in (1, 2, 4)),
                *(("show", name) for name in ("picture", "depth")),
                *(("lights", name) for name in ("studio", "none")),
                ("split", None),
                ("split", {"left": "paper", "right": "engine"}),
                ("split", {"left": "engine", "right": "reference"}),
                ("colour", {"by": "height"}),
                ("colour", {"by": "default"}),
                ("background", "#ff0000"),
            ]
        ),
    ),
)


@given(st.lists(st.lists(MESSAGES, max_size=4), max_size=8))
@settings(max_examples=40)
def test_whatever_a_person_does_a_picture_follows(small, rounds):
    """No exception but errors of one line; a finite camera; numbers of frames that rise."""
    clock = Clock()
    session = Session(ball(), clock=clock)
    session.queue(event("resize", width=40, height=32))
    session.take(small, None)
    frames, outputs = [0], []
    for messages in [*rounds, [{"type": "moving", "value": False}]]:
        for message in messages:
            session.queue(check_event(message))
        clock.now += 0.1
        outputs += session.work()
    clock.now += QUIET
    while session.due() == 0.0:
        outputs += session.work()
    shown = pictures(outputs)
    for picture in shown:
        assert picture.frame == frames[-1] + (not picture.second)
        frames.append(picture.frame)
    last = [picture for picture in shown if picture.frame == frames[-1]]
    assert all(picture.refined for picture in last)
    assert all(picture.rgba.shape == (*session.size[::-1], 4) for picture in last)
    assert len(last) == (1 if session.choices.split is None else 2)
    numbers = (*session.camera.target, session.camera.distance, *session.camera.orbit)
    assert np.isfinite(numbers).all()
    json.dumps([out for out in outputs if isinstance(out, dict)], allow_nan=False)
    assert all("\n" not in error["text"] for error in texts(outputs, "error"))
