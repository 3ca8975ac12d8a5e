"""The widget: a session of the live view, whose messages go through the notebook."""

from __future__ import annotations

import asyncio
import base64
from importlib import resources
from typing import Any

import anywidget
import traitlets

from splatline.contract.errors import InputError
from splatline.view.draw import draw
from splatline.view.events import check_event
from splatline.view.outputs import Output, SavedFile
from splatline.view.outputs import Picture as Frame
from splatline.view.picture import Picture
from splatline.view.server.png import png_bytes
from splatline.view.session import Session

__all__ = ["CloudView"]

VIEW = resources.files("splatline.view")

MOST_UNSHOWN = 2
"""Frames that may be under way or waiting in the browser."""

BREATH = 0.01
"""Seconds between two pictures in which the kernel takes messages, so that the latest counts."""

PNG = 1
"""Encoding of a picture, as in the live view's protocol."""


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

    _esm = "\n".join(
        VIEW.joinpath(*place).read_text(encoding="utf-8")
        for place in (("page", "canvas.js"), ("notebook", "widget.js"))
    )
    width = traitlets.Int(512).tag(sync=True)
    height = traitlets.Int(512).tag(sync=True)
    background = traitlets.Unicode("#171a1f").tag(sync=True)

    def __init__(self, session: Session, size: tuple[int, int]) -> None:
        self._session = session
        self._size = size
        self._sent = self._shown = 0
        self._last: list[Frame] = []
        self._timer: asyncio.TimerHandle | None = None
        try:
            self._loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            self._loop = None
        levels = session.choices.settings.background
        colour = "#" + "".join(f"{round(255.0 * level):02x}" for level in levels)
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
                self.send({"type": "error", "text": " ".join(str(error).split())})
                return
            if event.kind == "shown":
                self._shown = max(self._shown, min(event.values["frame"], self._sent))
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
        may_draw = self._sent - self._shown < MOST_UNSHOWN
        for output in self._session.work(may_draw=may_draw):
            self._answer(output)
        may_draw = self._sent - self._shown < MOST_UNSHOWN
        return self._session.due() if may_draw or self._session.waiting else None

    def _answer(self, output: Output) -> None:
        """Send an output of the session."""
        if isinstance(output, Frame):
            self._sent = max(self._sent, output.frame)
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
            "kind": 2 if frame.second else 1,
            "frame": frame.frame,
            "width": width,
            "height": height,
            "encoding": PNG,
            "refined": frame.refined,
        }
        self.send(header, [png_bytes(frame.rgba[..., :3])])
