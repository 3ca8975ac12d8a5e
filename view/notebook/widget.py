"""The widget: a session of the live view, whose messages go through the notebook."""

from __future__ import annotations

import asyncio
import base64
import re
from collections.abc import Sequence
from importlib import resources
from typing import Any

import anywidget
import traitlets

from splatline.contract.errors import InputError
from splatline.view.draw import draw
from splatline.view.events import check_event
from splatline.view.hex_colour import hex_colour
from splatline.view.outputs import Output, SavedFile, error_message
from splatline.view.outputs import Picture as Frame
from splatline.view.picture import Picture
from splatline.view.server.png import png_bytes
from splatline.view.server.protocol import PICTURE, PNG, SECOND
from splatline.view.session import Session
from splatline.view.unshown import Unshown

__all__ = ["CloudView"]

MODULES = (
    "page/gestures.js",
    "page/picture.js",
    "page/canvas.js",
    "page/download.js",
    "notebook/widget.js",
)
"""The widget's module, after those of the page that it needs."""

BREATH = 0.01
"""Seconds between two pictures in which the kernel takes messages, so that the latest counts."""


def _joined(modules: Sequence[str]) -> str:
    """Return some modules as one: what they import of each other is in it."""
    folder = resources.files("splatline.view")
    texts = (folder.joinpath(name).read_text(encoding="utf-8") for name in modules)
    return re.sub("^import .*;\n", "", "\n".join(texts), flags=re.MULTILINE)


class CloudView(anywidget.AnyWidget):
    """A view of a cloud in a notebook.

    Messages are those of the live view (``view/server/protocol.py``) as custom messages of the
    widget. The header of a picture is an object, and its PNG is a buffer. One more message,
    ``{"type": "hello"}``, comes from each view as it opens, and is answered by the last picture.

    Pictures are drawn by the kernel's own thread between its messages. Compiled code holds Python's
    lock, so another thread would gain nothing.

    Parameters
    ----------
    session
        What is seen; it has its cloud.
    size
        Width and height in pixels of the page.
    """

    _esm = _joined(MODULES)
    width = traitlets.Int(512).tag(sync=True)
    height = traitlets.Int(512).tag(sync=True)
    background = traitlets.Unicode("#171a1f").tag(sync=True)

    def __init__(self, session: Session, size: tuple[int, int]) -> None:
        self._session = session
        self._size = size
        self._unshown = Unshown()
        self._last: list[Frame] = []
        self._timer: asyncio.TimerHandle | None = None
        try:
            self._loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            self._loop = None
        colour = hex_colour(session.choices.settings.background)
        super().__init__(width=size[0], height=size[1], background=colour)
        self.on_msg(self._receive)

    @property
    def camera(self) -> Any:
        """The camera as it is now; ``render(cloud, camera=view.camera)`` draws what is seen."""
        camera = self._session.camera
        assert camera is not None
        return camera

    @property
    def picture(self) -> Picture:
        """The picture that is seen, of the view's size and with all samples."""
        live, settings = self._session.live, self._session.choices.settings
        assert live is not None
        return Picture(draw(live, self.camera, self._size, settings))

    def __repr__(self) -> str:
        return f"<CloudView {self.width}x{self.height} of {self._session.subject.name}>"

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """Return the widget, and its picture for where no kernel runs."""
        bundle = super()._repr_mimebundle_(**options)
        data, rest = bundle if isinstance(bundle, tuple) else (bundle, {})
        if data is not None:
            data = {**data, "image/png": base64.b64encode(self.picture.png).decode()}
        return data, rest

    def _receive(self, _: Any, message: Any, buffers: Any) -> None:
        """Take a message from a view. What follows from it is done soon."""
        kind = message.get("type") if isinstance(message, dict) else None
        if kind == "hello":
            for frame in self._last:
                self._send_frame(frame)
        else:
            try:
                event = check_event(message)
            except InputError as error:
                self.send(error_message(error))
                return
            if event.kind == "shown":
                self._unshown.note_shown(event.values["frame"])
            else:
                self._session.queue(event)
        self._wake(0.0)

    def _wake(self, delay: float) -> None:
        """Work after some seconds; at once if no loop runs."""
        if self._loop is None:
            while self.work() == 0.0:
                pass
        else:
            self._loop.call_soon_threadsafe(self._set_timer, delay)

    def _set_timer(self, delay: float) -> None:
        """Set the one timer, which rings no sooner than the kernel has taken what waits."""
        assert self._loop is not None
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_later(max(delay, BREATH), self._ring)

    def _ring(self) -> None:
        """Work, and set the timer for what is to be done next."""
        self._timer = None
        delay = self.work()
        if delay is not None:
            self._set_timer(delay)

    def work(self) -> float | None:
        """Apply all events and draw what is due; return the seconds until there is more to do."""
        for output in self._session.work(may_draw=self._unshown.are_few):
            self._answer(output)
        return self._session.due(may_draw=self._unshown.are_few)

    def _answer(self, output: Output) -> None:
        """Send an output of the session."""
        if isinstance(output, Frame):
            self._unshown.note_sent(output.frame)
            self._last = [*self._last, output] if output.second else [output]
            self._send_frame(output)
        elif isinstance(output, SavedFile):
            told = {"type": "file", "name": output.name, "mime": output.mime}
            self.send(told, [output.data])
        else:
            self.send(output)

    def _send_frame(self, frame: Frame) -> None:
        """Send a picture."""
        height, width = frame.rgba.shape[:2]
        header = {
            "type": "picture",
            "kind": SECOND if frame.second else PICTURE,
            "frame": frame.frame,
            "width": width,
            "height": height,
            "encoding": PNG,
            "refined": frame.refined,
        }
        self.send(header, [png_bytes(frame.rgba[..., :3])])
