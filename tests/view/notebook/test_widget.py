"""The widget's messages, with a comm that notes them."""

import asyncio
import base64
import importlib.util
import io
import re
import time

import numpy as np
import pytest
from PIL import Image

from splatline.view.draw import Settings, draw
from splatline.view.notebook.show import show
from splatline.view.notebook.widget import CloudView
from splatline.view.picture import Picture
from tests.support.clouds import sphere


class Page:
    """The browser's end of a widget: it sends messages and notes the answers."""

    def __init__(self, widget):
        self.widget = widget
        self.answers = []
        widget.send = lambda content, buffers=None: self.answers.append((content, buffers))

    def send(self, *messages):
        """Send messages as the comm would; return the answers."""
        self.answers.clear()
        for message in messages:
            self.widget._handle_custom_msg(message, [])
        return self.answers

    def rest(self):
        """Acknowledge until the refined picture is there; return its header and its pixels."""
        for _ in range(20):
            found = self.pictures()
            if found and found[-1][0]["refined"]:
                return found[-1]
            time.sleep(0.05)
            self.send({"type": "shown", "frame": self.widget._unshown.sent})
        raise AssertionError("no refined picture")

    def pictures(self):
        return [
            (content, np.array(Image.open(io.BytesIO(buffers[0]))))
            for content, buffers in self.answers
            if content["type"] == "picture"
        ]


@pytest.fixture
def cloud():
    return sphere(500)


@pytest.fixture
def view(cloud):
    made = show(cloud, size=(64, 48), samples=4, preset="paper")
    assert isinstance(made, CloudView)
    return made


def golden(view, size, samples=4):
    """Return the picture of the view's camera."""
    preset = view._session.choices.settings.preset
    return draw(view._session.live, view.camera, size, Settings(preset, samples=samples)).rgba


def test_a_view_that_opens_gets_a_picture(view):
    page = Page(view)
    answers = page.send({"type": "hello"})
    assert [content["type"] for content, _ in answers][:2] == ["settings", "picture"]
    header, pixels = page.rest()
    assert header["encoding"] == 1
    assert pixels.shape == (header["height"], header["width"], 3) == (48, 64, 3)
    assert (pixels == golden(view, (64, 48))[..., :3]).all()
    # Another view of the same widget gets the picture that is there.
    (content, buffers), *_ = page.send({"type": "hello"})
    assert content == header
    assert (np.array(Image.open(io.BytesIO(buffers[0]))) == pixels).all()


def test_what_the_hand_does_is_seen(view):
    page = Page(view)
    page.send({"type": "hello"})
    _, before = page.rest()
    camera = view.camera
    page.send(
        {"type": "resize", "width": 96, "height": 72},
        {"type": "turn", "dx": 20, "dy": 5},
        {"type": "zoom", "factor": 0.5, "x": 40, "y": 30},
    )
    header, pixels = page.rest()
    assert view.camera.azimuth != camera.azimuth
    assert view.camera.distance < camera.distance
    assert (header["width"], header["height"]) == (96, 72)
    assert pixels.shape != before.shape
    assert (pixels == golden(view, (96, 72))[..., :3]).all()
    numbers = [content for content, _ in page.answers if content["type"] == "numbers"]
    assert numbers[-1]["samples"] == 4


def test_no_more_than_two_frames_are_under_way(view):
    page = Page(view)
    page.send({"type": "hello"})
    turn = {"type": "turn", "dx": 1, "dy": 0}
    page.send(*[turn] * 10)
    assert not view._unshown.are_few
    assert view._unshown.sent == 2
    assert page.send(turn) == [] or page.pictures() == []
    page.send({"type": "shown", "frame": view._unshown.sent})
    assert page.pictures()


def test_a_file_is_a_buffer(view):
    page = Page(view)
    page.send({"type": "hello"})
    page.rest()
    told, buffers = page.send({"type": "save", "what": "png"})[0]
    assert told == {"type": "file", "name": "test.png", "mime": "image/png"}
    assert (np.array(Image.open(io.BytesIO(buffers[0]))) == golden(view, (64, 48))[..., :3]).all()


@pytest.mark.parametrize("message", [{"type": "absent"}, {"type": "turn", "dx": "far"}, 7, None])
def test_a_bad_message_is_answered_by_a_line(view, message):
    page = Page(view)
    (content, _), *_ = page.send(message)
    assert content["type"] == "error"
    assert "\n" not in content["text"]


def test_what_is_seen_can_be_drawn(view, cloud):
    page = Page(view)
    page.send({"type": "hello"}, {"type": "turn", "dx": 30, "dy": 0})
    assert (view.picture.rgb == golden(view, (64, 48))[..., :3]).all()
    data, _ = view._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert base64.b64decode(data["image/png"]) == view.picture.png


def test_the_module_holds_the_page_s_canvas(view):
    assert "export function attachCanvas(" in view._esm
    assert "export default { render };" in view._esm
    assert not re.search(r"^import ", view._esm, re.MULTILINE)


def test_without_anywidget_it_is_a_still_picture(cloud, monkeypatch, capsys):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *more: None if name == "anywidget" else find(name, *more),
    )
    picture = show(cloud, size=(64, 48))
    assert isinstance(picture, Picture)
    assert picture.size == (64, 48)
    assert capsys.readouterr().err.count("\n") == 1


def test_the_kernel_s_loop_draws_between_messages(cloud):
    """The latest of many messages counts: not each is drawn."""

    async def kernel():
        page = Page(show(cloud, size=(64, 48)))
        page.send({"type": "hello"}, *[{"type": "turn", "dx": 2, "dy": 0}] * 30)
        assert page.pictures() == []
        for _ in range(200):
            await asyncio.sleep(0.01)
            found = page.pictures()
            if found:
                shown = {"type": "shown", "frame": found[-1][0]["frame"]}
                page.widget._handle_custom_msg(shown, [])
            if found and found[-1][0]["refined"]:
                break
        assert found[-1][0]["refined"]
        assert len(found) <= 4
        assert (found[-1][1] == golden(page.widget, (64, 48), 1)[..., :3]).all()

    asyncio.run(kernel())
