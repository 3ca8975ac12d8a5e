"""A session: events in, pictures out, the latest first."""

import numpy as np
import pytest

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.choices import Choices
from splatline.view.draw import Settings, draw
from splatline.view.live_cloud import live_cloud
from splatline.view.pace import Pace
from splatline.view.session import QUIET, Session
from tests.support.clouds import cloud_of
from tests.view.views import SIZE, ball, event, last_picture, pictures, set_to, texts


def test_before_the_cloud_is_read_nothing_is_drawn(clock):
    session = Session(ball(), clock=clock)
    assert session.needs_cloud
    for each in (
        event("resize", width=100, height=50), event("turn", dx=1, dy=1), event("reset"),
        set_to("samples", 4), event("look", x=1, y=1),
    ):  # fmt: skip
        session.queue(each)
    outputs = session.work()
    assert not pictures(outputs)
    [settings] = texts(outputs, "settings")
    assert settings["samples"] == 4
    assert settings["camera"] is None
    assert session.due() is None
    for each in (event("save", what="png"), event("command")):
        session.queue(each)
    assert len(texts(session.work(), "error")) == 2


def test_the_first_picture_is_refined_with_its_numbers(live, clock):
    session = Session(ball(), Choices(Settings(samples=4)), clock=clock)
    session.queue(event("resize", width=SIZE[0], height=SIZE[1]))
    session.take(live, None)
    first = session.work()
    [quick] = pictures(first)
    assert (quick.frame, quick.refined, quick.second) == (1, False, False)
    second = session.work()
    [refined] = pictures(second)
    assert (refined.frame, refined.refined) == (2, True)
    third = session.work()
    assert not pictures(third)
    [numbers] = texts(third, "numbers")
    assert (numbers["frame"], numbers["samples"], numbers["psnr"]) == (2, 4, None)
    [settings] = texts(third, "settings")
    assert settings["camera"]["distance"] == session.camera.distance
    assert session.due() is None
    drawn = draw(live, session.camera, SIZE, Settings(samples=4))
    assert np.array_equal(refined.rgba, drawn.rgba)


def test_all_events_are_applied_before_one_picture_is_drawn(session, live):
    before = session.camera
    for _ in range(50):
        session.queue(event("turn", dx=0.4, dy=-0.2))
    shown = pictures(session.work())
    assert len(shown) == 1
    a_pixel = 180.0 / min(SIZE)
    assert session.camera.azimuth == pytest.approx(before.azimuth - 20 * a_pixel, abs=0.01)
    assert session.camera.elevation == pytest.approx(before.elevation - 10 * a_pixel, abs=0.01)
    quick = Settings(close_specks=False)
    assert np.array_equal(shown[0].rgba, draw(live, session.camera, SIZE, quick).rgba)


def test_nothing_is_drawn_while_too_much_is_under_way(session):
    session.queue(event("turn", dx=5, dy=0))
    session.queue(event("command"))
    outputs = session.work(may_draw=False)
    assert not pictures(outputs)
    assert texts(outputs, "command")
    assert session.due() == 0.0
    session.queue(event("turn", dx=5, dy=0))
    assert len(pictures(session.work())) == 1


def test_a_picture_is_refined_when_the_camera_rests(session, live, clock):
    session.queue(event("moving", value=True))
    session.queue(event("turn", dx=5, dy=0))
    [moving] = pictures(session.work())
    assert not moving.refined
    assert session.due() is None  # the button is down
    session.queue(event("moving", value=False))
    assert not pictures(session.work())
    assert session.due() == pytest.approx(QUIET)
    clock.now += QUIET
    assert session.due() == 0.0
    [rested] = pictures(session.work())
    assert rested.refined
    # While it moves, its specks are not closed.
    quick = draw(live, session.camera, SIZE, Settings(close_specks=False))
    assert np.array_equal(moving.rgba, quick.rgba)
    assert np.array_equal(rested.rgba, draw(live, session.camera, SIZE).rgba)
    assert not np.array_equal(rested.rgba, moving.rgba)
    assert texts(session.work(), "numbers")[0]["frame"] == rested.frame
    assert session.due() is None


def test_a_wheel_without_a_button_is_refined_after_a_while(session, clock):
    for _ in range(3):
        session.queue(event("zoom", factor=0.9, x=40, y=40))
        [shown] = pictures(session.work())
        assert not shown.refined
        assert session.due() == pytest.approx(QUIET)
        clock.now += QUIET / 2
    clock.now += QUIET
    assert last_picture(session).refined


def test_slow_pictures_are_coarse_while_moving_and_full_at_rest(live, clock):
    class Slow(Pace):
        divisor = 4.0

    session = Session(ball(), Choices(Settings(samples=4)), pace=Slow, clock=clock)
    session.queue(event("resize", width=96, height=80))
    session.take(live, None)
    session.queue(event("moving", value=True))
    session.queue(event("turn", dx=5, dy=0))
    [shown] = pictures(session.work())
    assert shown.rgba.shape == (20, 24, 4)
    session.queue(event("moving", value=False))
    clock.now += QUIET
    found = []
    while session.due() == 0.0:
        found += pictures(session.work())
    assert [(each.rgba.shape[0], each.refined) for each in found] == [(80, False), (80, True)]
    assert [each.frame for each in found] == [shown.frame + 1, shown.frame + 2]


def test_refining_ends_when_something_happens(session, clock, live, monkeypatch):
    session.queue(set_to("samples", 16))
    [quick] = pictures(session.work())
    checks = 0

    def check():
        nonlocal checks
        checks += 1
        if checks == 3:
            session.queue(event("turn", dx=1, dy=0))
        return Session._check(session)

    monkeypatch.setattr(session._easel, "_check", check)
    assert not pictures(session.work())
    assert checks == 3
    [moved] = pictures(session.work())
    assert (moved.frame, moved.refined) == (quick.frame + 1, False)
    clock.now += QUIET
    assert last_picture(session).refined


def test_a_camera_that_never_moved_fits_every_size(session, live):
    session.queue(event("resize", width=300, height=60))
    session.work()
    assert session.camera == ball().home(live, (300, 60)).rounded()
    session.queue(event("turn", dx=1, dy=0))
    session.work()
    before = session.camera
    session.queue(event("resize", width=90, height=80))
    session.work()
    assert session.camera == before
    session.queue(event("reset"))
    session.work()
    assert session.camera == ball().home(live, (90, 80)).rounded()


def test_a_double_click_looks_at_the_point_there(session):
    session.queue(event("look", x=0, y=0))
    session.work()
    assert session.due() is None  # background: nothing happens
    session.queue(event("look", x=60, y=30))
    session.work()
    assert np.linalg.norm(session.camera.target) == pytest.approx(1.0, abs=0.05)
    # The point stands in the middle now.
    depth = session._easel.seen[0].depth_at(48, 40)
    assert depth == pytest.approx(session.camera.distance, rel=0.02)


@pytest.mark.parametrize(
    ("name", "value"),
    [("lights", "side"), ("background", "#ff0000"), ("preset", "paper"), ("quality", "fast"),
     ("samples", 4), ("show", "depth")],
)  # fmt: skip
def test_a_setting_is_told_and_drawn(session, name, value):
    session.queue(event("turn", dx=1, dy=0))
    session.work()
    before = draw(session.live, session.camera, SIZE).rgba
    session.queue(set_to(name, value))
    outputs = session.work()
    assert texts(outputs, "settings")[0][name] == value
    session._moved_at -= QUIET
    last_frame = last_picture(session)
    assert last_frame.refined
    if name not in ("quality",):
        assert not np.array_equal(last_frame.rgba, before)


def test_planes_have_no_quality_paper(session):
    session.queue(set_to("quality", "paper"))
    session.queue(set_to("preset", "plane"))
    [settings] = texts(session.work(), "settings")
    assert (settings["preset"], settings["quality"]) == ("plane", "exact")
    session.queue(set_to("quality", "paper"))
    outputs = session.work()
    [error] = texts(outputs, "error")
    assert "take quality exact" in error["text"]
    assert session.choices.settings.quality == "exact"


def test_colours_are_read_elsewhere_and_refused_if_there_are_none(session, live):
    height = ColourBy("height")
    session.queue(set_to("colour", {"by": "height"}))
    session.work()
    assert session.needs_cloud
    assert session.choices.colour == height
    session.take(live, ColourBy("other"))  # comes too late
    assert session.needs_cloud
    session.take(live, height)
    assert not session.needs_cloud
    assert "--colour" in session.command()
    session.queue(set_to("colour", {"by": "nothing"}))
    session.work()
    assert "height" in session.command()  # what is shown
    session.refuse(ColourBy("nothing"))
    assert session.choices.colour == height
    session.queue(set_to("colour", {"by": "height", "map": "no such map"}))
    [error] = texts(session.work(), "error")
    assert "no colour map" in error["text"]


def test_an_error_of_drawing_is_told_once(session, monkeypatch):
    def fail(*_, **__):
        raise InputError("too\nbad")

    monkeypatch.setattr("splatline.view.easel.draw", fail)
    session.queue(event("turn", dx=1, dy=0))
    [error] = texts(session.work(), "error")
    assert error["text"] == "too bad"
    assert session.due() is None


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("scale", [0.0, 1e-200, 1e60])
def test_clouds_without_a_size_or_of_any_size_are_shown(clock, count, scale):
    positions = scale * np.arange(3 * count).reshape(count, 3)
    live = live_cloud(cloud_of(positions, np.tile([0.0, 0.0, 1.0], (count, 1)), two_sided=True))
    session = Session(ball(), clock=clock)
    session.queue(event("resize", width=40, height=32))
    session.take(live, None)
    assert last_picture(session).refined
    session.queue(event("zoom", factor=0.5, x=3, y=3))
    session.queue(event("turn", dx=30, dy=3))
    clock.now += QUIET
    assert np.isfinite(session.camera.rounded().distance)
    assert pictures(session.work())
