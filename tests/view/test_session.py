"""A session: events in, pictures out, the latest first."""

import io
import json
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from splatline.contract.errors import InputError
from splatline.contract.presets import PRESETS
from splatline.host.files.wanted import ColourBy
from splatline.host.frame_file import load_frame
from splatline.sim.golden.renderer import render
from splatline.view.choices import Choices
from splatline.view.draw import Settings, draw
from splatline.view.events import check_event
from splatline.view.live_cloud import live_cloud
from splatline.view.pace import Pace
from splatline.view.session import QUIET, Session
from tests.support.clouds import cloud_of, sphere
from tests.view.test_events import MOVES
from tests.view.views import ball, event, last_picture, pictures

SIZE = (96, 80)


class Clock:
    """A clock that is moved by hand."""

    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture(scope="module")
def live():
    return ball().read(None)


@pytest.fixture(scope="module")
def small():
    return live_cloud(sphere(200))


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def session(live, clock):
    """A session that shows the refined first picture."""
    session = Session(ball(), clock=clock)
    session.queue(event("resize", width=SIZE[0], height=SIZE[1]))
    session.take(live, None)
    last_picture(session)
    return session


def texts(outputs, kind):
    """Return the messages of one type."""
    return [out for out in outputs if isinstance(out, dict) and out["type"] == kind]


def set_to(name, value):
    return event("set", name=name, value=value)


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
    assert np.array_equal(shown[0].rgba, draw(live, session.camera, SIZE).rgba)


def test_nothing_is_drawn_while_too_much_is_under_way(session):
    session.queue(event("turn", dx=5, dy=0))
    session.queue(event("command"))
    outputs = session.work(may_draw=False)
    assert not pictures(outputs)
    assert texts(outputs, "command")
    assert session.due() == 0.0
    session.queue(event("turn", dx=5, dy=0))
    assert len(pictures(session.work())) == 1


def test_a_picture_is_refined_when_the_camera_rests(session, clock):
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
    assert np.array_equal(rested.rgba, moving.rgba)
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
    assert session.due() == 0.0


def test_a_closed_session_ends_its_work(session):
    session.queue(set_to("split", {"left": "engine", "right": "reference"}))

    def close():
        session.closed = True

    session.call(lambda text, share: None, close)
    found = []
    for _ in range(4):
        found += pictures(session.work())
    assert not any(each.second for each in found)


def test_a_picture_is_saved_with_all_samples_also_while_moving(session, live, clock):
    session.queue(set_to("samples", 4))
    session.queue(event("moving", value=True))
    session.queue(event("turn", dx=5, dy=0))
    session.queue(event("save", what="png"))
    saved = session.work()[0]
    assert (saved.name, saved.mime) == ("ball.png", "image/png")
    pixels = np.asarray(Image.open(io.BytesIO(saved.data)))
    drawn = draw(live, session.camera, SIZE, Settings(samples=4))
    assert np.array_equal(pixels, drawn.rgba[..., :3])


@pytest.mark.parametrize(("samples", "size"), [(1, SIZE), (4, SIZE), (1, (600, 80))])
def test_saved_code_words_draw_the_picture(session, live, samples, size, tmp_path):
    session.queue(set_to("samples", samples))
    session.queue(event("resize", width=size[0], height=size[1]))
    session.queue(event("save", what="words"))
    saved = session.work()[0]
    assert saved.mime == "application/zip"
    with zipfile.ZipFile(io.BytesIO(saved.data)) as archive:
        names = sorted(archive.namelist())
        archive.extractall(tmp_path)
    frames = [load_frame(tmp_path / name) for name in names if name.endswith(".frame")]
    drawing = draw(live, session.camera, size, Settings(samples=samples))
    assert len(frames) == len(drawing.frames)
    assert len(names) == 2 * len(frames)
    if size == SIZE:
        for frame, raster in zip(frames, drawing.rasters, strict=True):
            assert render(frame).mismatches(raster) == 0


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
