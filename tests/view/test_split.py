"""A split view: two pictures of one number."""

import numpy as np
import pytest

from splatline.contract.presets import PRESETS
from splatline.view.draw import Settings, draw
from splatline.view.session import QUIET
from tests.view.views import SIZE, event, pictures, set_to, texts


def test_a_split_view_has_both_pictures_of_one_number(session, live):
    session.queue(set_to("split", {"left": "paper", "right": "engine"}))
    found = []
    while session.due() == 0.0:
        found.append(session.work())
    left, right = pictures(found[-2])
    assert texts(found[-1], "numbers")[0]["frame"] == left.frame
    assert (left.frame, left.second, right.second) == (right.frame, False, True)
    assert left.refined
    assert right.refined
    paper = Settings(preset=PRESETS["paper"], quality="paper")
    assert np.array_equal(left.rgba, draw(live, session.camera, SIZE, paper).rgba)
    assert np.array_equal(right.rgba, draw(live, session.camera, SIZE).rgba)
    assert not any(each.second for outputs in found[:-2] for each in pictures(outputs))


@pytest.mark.parametrize("show", ["picture", "depth"])
def test_the_reference_comes_after_the_engine_s_picture(session, show, clock):
    told, between = [], []
    session.call(lambda text, share: told.append((text, share)), lambda: between.append(None))
    session.queue(set_to("show", show))
    session.queue(set_to("split", {"left": "reference", "right": "engine"}))
    found = []
    while session.due() == 0.0:
        found.append(session.work())
    [alone] = pictures(found[-3])
    exact, engine = pictures(found[-1])
    assert alone.refined
    assert np.array_equal(alone.rgba, engine.rgba)
    assert (exact.second, engine.second) == (False, True)
    apart = np.abs(exact.rgba.astype(int) - engine.rgba.astype(int)).mean()
    assert 0.0 < apart < 16.0
    [numbers] = texts(found[-1], "numbers")
    assert 14.0 < numbers["psnr"] < 60.0
    assert told[-1] == ("", 1.0)
    assert told[0][0] == "Drawing the exact reference"
    assert between
    # What is drawn is kept: the other side is there at once.
    told.clear()
    session.queue(set_to("split", {"left": "engine", "right": "reference"}))
    while session.due() == 0.0:
        found.append(session.work())
    assert np.array_equal(pictures(found[-1])[1].rgba, exact.rgba)
    assert not told
    # After a turn it is another one.
    session.queue(event("turn", dx=30, dy=0))
    session.work()
    clock.now += QUIET
    while session.due() == 0.0:
        found.append(session.work())
    assert told
    assert not np.array_equal(pictures(found[-1])[1].rgba, exact.rgba)


def test_the_reference_is_given_up_when_the_camera_moves(session):
    session.queue(set_to("split", {"left": "engine", "right": "reference"}))
    session.call(lambda text, share: None, lambda: session.queue(event("turn", dx=1, dy=0)))
    found = []
    for _ in range(3):
        found += pictures(session.work())
    assert not any(each.second for each in found)
    assert session.due() is not None  # there is more to draw


def test_a_closed_session_ends_its_work(session):
    session.queue(set_to("split", {"left": "engine", "right": "reference"}))

    def close():
        session.closed = True

    session.call(lambda text, share: None, close)
    found = []
    for _ in range(4):
        found += pictures(session.work())
    assert not any(each.second for each in found)
