"""A page of the live view in the browser: what a person sees of it and does to it."""

import base64
import io
import json

import numpy as np
from PIL import Image

PATIENCE = 30_000  # ms; this is long because a loaded machine is slow

RETRY = "WebSocket connection to 'ws://"
"""Chromium itself writes such a line for each attempt to connect that fails. The page cannot
prevent it, so while a server is away these lines, and these alone, are no errors."""


class LivePage:
    """A page.

    Parameters
    ----------
    page
        Playwright's.
    """

    def __init__(self, page):
        self.page = page
        self.errors = []
        self.retries = []
        self.patience = PATIENCE
        self.received = []
        self._refined = 0  # pictures that were refined, with figures and then settings
        self._numbers = None  # figures whose settings are still to come
        self._last = None  # figures and settings of the last refined picture
        page.on("websocket", lambda socket: socket.on("framereceived", self._hear))
        page.on("console", self._note)
        page.on("pageerror", lambda error: self.errors.append(f"uncaught: {error}"))

    def open(self, address):
        self.page.goto(address)
        self.page.wait_for_selector("#picture canvas", timeout=self.patience)

    def impatient(self, patience):
        """Wait for so many ms at most from now on."""
        self.patience = patience
        self.page.set_default_timeout(patience)

    def stage(self, **wanted):
        """Wait until the stage's notes of the last picture have some values."""
        tests = "".join(f"[data-{name}='{value}']" for name, value in wanted.items())
        self.page.wait_for_selector(f"#stage{tests}", timeout=self.patience)

    def text(self, selector):
        return self.page.inner_text(selector)

    def pixels(self):
        """Return the canvas as an array of shape (height, width, 4), uint8."""
        address = self.page.evaluate("document.querySelector('canvas').toDataURL('image/png')")
        data = base64.b64decode(address.partition(",")[2])
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))

    def canvas_size(self):
        """Return width and height of the canvas in device pixels."""
        return tuple(
            self.page.evaluate(
                "[document.querySelector('canvas').width, document.querySelector('canvas').height]"
            )
        )

    def drag(self, start, end, *, button="left", steps=5):
        """Drag from one place to another, in CSS pixels of the window."""
        mouse = self.page.mouse
        mouse.move(*start)
        mouse.down(button=button)
        mouse.move(*end, steps=steps)
        mouse.up(button=button)

    def downloaded(self, click):
        """Return name and bytes of the file that a click saves."""
        with self.page.expect_download(timeout=self.patience) as waiting:
            self.page.click(click)
        download = waiting.value
        return download.suggested_filename, download.path().read_bytes()

    def touch(self, kind, *points):
        """Send a touch event: kind is touchStart, touchMove or touchEnd; points are (x, y)."""
        if not hasattr(self, "_wire"):
            self._wire = self.page.context.new_cdp_session(self.page)
        places = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self._wire.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    def told(self, kind):
        """Return the last message of a type that the server sent."""
        return next(message for message in reversed(self.received) if message["type"] == kind)

    def settled(self, act=None):
        """Do something, and wait until the picture that follows is refined and its figures shown.

        Returns the settings that the server sent with it.
        """
        before = 0
        if act is not None:
            self.settled()
            before = self._refined
            act()
        for _ in range(self.patience // 20):
            shown = self.page.get_attribute("#stage", "data-frame")
            if self._refined > before and self._numbers is None:
                numbers, settings = self._last
                whole = (numbers["width"], numbers["height"]) == self.canvas_size()
                if whole and shown == str(numbers["frame"]):
                    return settings
            self.page.wait_for_timeout(20)
        last = [message["type"] for message in self.received[-8:]]
        raise AssertionError(
            f"no refined picture came; frame {shown} is shown, and last came {last}"
        )

    def _hear(self, payload):
        if not isinstance(payload, str):
            return
        message = json.loads(payload)
        self.received.append(message)
        if message["type"] == "numbers":
            self._numbers = message
        elif message["type"] == "settings" and self._numbers is not None:
            self._last = self._numbers, message
            self._refined += 1
            self._numbers = None

    def _note(self, message):
        if message.type not in ("error", "warning"):
            return
        is_retry = message.text.startswith(RETRY) and "failed" in message.text
        (self.retries if is_retry else self.errors).append(f"{message.type}: {message.text}")
