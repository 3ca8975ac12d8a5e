"""The command line of a live view makes its very picture."""

import shlex

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from splatline.cli.main import main
from splatline.contract.presets import PRESETS
from splatline.host.files.wanted import ColourBy
from splatline.view.choices import Choices
from splatline.view.draw import Settings
from splatline.view.session import Session
from splatline.view.subject import Subject
from tests.host.files.las_files import COUNT, las
from tests.view.views import event, last_picture, write_ball


@pytest.fixture
def far_scan(tmp_path):
    """A sphere at coordinates of a national grid."""
    middle = (512_345.25, 5_403_210.5, 271.125)
    return write_ball(tmp_path / "a ball.csv", size=12.5, middle=middle)


def run_splatline(words, picture):
    """Run a command line of splatline; return the picture that it writes."""
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, result.output
    return np.asarray(Image.open(picture))


def assert_shows_more_than(colours, written, shown):
    """Check that a file holds a shown picture, and that its colours are more than so many."""
    assert np.array_equal(written, shown.rgba[..., :3])
    assert len(np.unique(written.reshape(-1, 3), axis=0)) > colours


MOVES = [
    event("turn", dx=37.0, dy=-21.5),
    event("pan", dx=-11.25, dy=4.0),
    event("zoom", factor=0.73, x=100.0, y=140.5),
]

CASES = {
    "plain": (Choices(), (320, 240)),
    "samples": (
        Choices(Settings(samples=4, lights="side", background=(1.0, 0.5019607843137255, 0.0))),
        (201, 160),
    ),
    "specks": (Choices(Settings(close_specks=False)), (320, 240)),
    "paper": (Choices(Settings(preset=PRESETS["paper"], quality="paper")), (256, 256)),
    "plane, tiles": (Choices(Settings(preset=PRESETS["plane"], lights="none")), (700, 530)),
    "swift, tiles, samples": (
        Choices(
            Settings(preset=PRESETS["swift"], samples=4, skips=frozenset({"outside", "hidden"})),
            ColourBy("warmth", "magma", (-0.75, 0.9)),
        ),
        (530, 200),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_command_of_a_session_makes_its_picture(name, far_scan, monkeypatch, tmp_path):
    choices, size = CASES[name]
    subject = Subject(path=far_scan, name="a ball", up="z", fov=31.5, orbit=(-50.0, 12.0))
    session = Session(subject, choices, clock=lambda: 1e3)
    session.take(subject.read(choices.colour), choices.colour)
    for each in [event("resize", width=size[0], height=size[1]), *MOVES, event("command")]:
        session.queue(each)
    [answer] = [out for out in session.work() if isinstance(out, dict) and "text" in out]
    session._clock = lambda: 2e3
    shown = last_picture(session)
    assert shown.refined
    assert shown.rgba.shape == (size[1], size[0], 4)

    monkeypatch.chdir(tmp_path)
    program, *words = shlex.split(answer["text"])
    lengths = {name: len(words[words.index(name) + 1]) for name in ("--orbit", "--distance")}
    assert all(length <= len("-123.45,-12.34") for length in lengths.values())
    assert program == "splatline"
    assert_shows_more_than(10, run_splatline(words, "a ball.png"), shown)
    assert (shown.rgba[..., 3] == 255).all()


def test_a_point_far_away_is_drawn_as_one_pixel_as_by_render(far_scan, monkeypatch, tmp_path):
    """No disc of a small cloud covers a pixel's centre; the picture is not empty."""
    subject = Subject(path=far_scan, name="far", up="z")
    session = Session(subject, clock=lambda: 1e3)
    session.take(subject.read(None), None)
    session.queue(event("resize", width=64, height=64))
    for _ in range(3):
        session.queue(event("zoom", factor=10.0, x=32.0, y=32.0))
    session.work()
    session._clock = lambda: 2e3
    shown = last_picture(session)
    monkeypatch.chdir(tmp_path)
    assert_shows_more_than(1, run_splatline(session.command(), "far.png"), shown)


def test_the_depth_is_that_of_render(far_scan, monkeypatch, tmp_path):
    subject = Subject(path=far_scan, name="ball", up="z")
    session = Session(subject, Choices(Settings(samples=4), show="depth"), clock=lambda: 1e3)
    session.take(subject.read(None), None)
    session.queue(event("resize", width=200, height=150))
    session.work()
    shown = last_picture(session)
    monkeypatch.chdir(tmp_path)
    levels = run_splatline(session.command(), "ball-depth.png")
    assert levels.max() > 256
    assert np.array_equal(levels >> 8, shown.rgba[..., 0])
    session.queue(event("save", what="png"))
    [saved] = session.work()
    assert saved.name == "ball-depth.png"
    (tmp_path / "saved.png").write_bytes(saved.data)
    assert np.array_equal(np.asarray(Image.open("saved.png")), levels)


@pytest.mark.parametrize("elevation", [40, -40])
def test_a_survey_is_drawn_as_by_render_from_above_and_below(elevation, monkeypatch, tmp_path):
    """Its upper side is the outer one if it is seen from above; noise is kept if asked for."""
    path = tmp_path / "survey.las"
    path.write_bytes(las(6, classes=np.full(COUNT, 18)))
    subject = Subject(path=path, name="survey", up="z", keep=frozenset({"noise"}))
    session = Session(subject, clock=lambda: 1e3)
    session.take(subject.read(None), None)
    session.queue(event("resize", width=160, height=120))
    session.queue(event("orbit", azimuth=10, elevation=elevation))
    session.work()
    session._clock = lambda: 2e3
    shown = last_picture(session)
    monkeypatch.chdir(tmp_path)
    assert_shows_more_than(3, run_splatline(session.command(), "survey.png"), shown)
