"""A tab: a WebSocket, and the session that it shows."""

from __future__ import annotations

import asyncio
import contextlib
import time
from concurrent.futures import Executor
from typing import Any

from aiohttp import WSMsgType, web

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.greeting import greeting
from splatline.view.live_cloud import LiveCloud
from splatline.view.outputs import Output, Picture, SavedFile, error_message
from splatline.view.session import Session
from splatline.view.unshown import Unshown

from .library import EVERY, Library
from .protocol import file_bytes, picture_bytes, read_message
from .turns import Turns

__all__ = ["Tab"]

MOST_EVENTS = 1000
"""Events that may wait for a picture; then no more are read."""


class Tab:
    """One tab of a browser.

    Parameters
    ----------
    socket
        The WebSocket, open.
    session
        What it shows.
    library
        Where the cloud comes from.
    executor, turns
        Where it is drawn.
    png
        Whether pictures are sent as PNG.
    """

    def __init__(
        self,
        socket: web.WebSocketResponse,
        session: Session,
        library: Library,
        executor: Executor,
        turns: Turns,
        *,
        png: bool,
    ) -> None:
        self._socket = socket
        self._session = session
        self._library = library
        self._executor = executor
        self._turns = turns
        self._png = png
        session.call(self._tell_from_thread, turns.pass_on)
        self._loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._unshown = Unshown()
        self._told_at = 0.0
        self._loading: asyncio.Task[None] | None = None
        self._messages: asyncio.Queue[dict[str, Any]] = asyncio.Queue()

    async def serve(self) -> None:
        """Serve the tab until it is closed."""
        drawing = asyncio.create_task(self._draw())
        telling = asyncio.create_task(self._tell())
        reading = asyncio.create_task(self._read())
        tasks = {drawing, telling, reading}
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        except ConnectionError:
            pass  # the tab was closed while something was sent to it
        finally:
            self._session.closed = True
            if self._loading is not None:
                tasks.add(self._loading)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _read(self) -> None:
        """Queue what the client sends."""
        async for message in self._socket:
            if message.type is not WSMsgType.TEXT:
                self._send_soon({"type": "error", "text": "a message must be text"})
                continue
            try:
                event = read_message(message.data)
            except InputError as error:
                self._send_soon(error_message(error))
                continue
            if event.kind == "shown":
                self._unshown.note_shown(event.values["frame"])
            else:
                self._session.queue(event)
            self._wake.set()
            while self._session.waiting > MOST_EVENTS:
                await asyncio.sleep(0.01)

    async def _draw(self) -> None:
        """Draw what is due, and send it."""
        while True:
            if self._session.needs_cloud and self._loading is None:
                self._loading = asyncio.create_task(self._load())
            self._wake.clear()
            may_draw = self._unshown.are_few
            delay = self._session.due(may_draw=may_draw)
            if delay != 0.0:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._wake.wait(), delay)
                continue
            outputs = await self._loop.run_in_executor(self._executor, self._work, may_draw)
            for output in outputs:
                await self._send(output)

    def _work(self, may_draw: bool) -> list[bytes | dict[str, Any]]:
        """Apply events and draw, in a thread, when it is this tab's turn."""
        with self._turns.turn():
            outputs = self._session.work(may_draw=may_draw)
        return [message for output in outputs for message in self._encoded(output)]

    def _encoded(self, output: Output) -> list[bytes | dict[str, Any]]:
        """Return the messages of an output."""
        if isinstance(output, Picture):
            self._unshown.note_sent(output.frame)
            return [picture_bytes(output, png=self._png)]
        if isinstance(output, SavedFile):
            told = {"name": output.name, "mime": output.mime, "bytes": len(output.data)}
            return [{"type": "file", **told}, file_bytes(output)]
        return [output]

    async def _load(self) -> None:
        """Read the cloud, at first or in other colours."""
        colour = self._session.choices.colour
        try:
            live = await self._library.get(colour, self._tell_progress)
        except InputError as error:
            self._send_soon(error_message(error))
            if self._session.live is None:
                return  # there is nothing to show; the task stays, lest it be read again
            self._session.refuse(colour)
        else:
            hello = await self._loop.run_in_executor(self._executor, self._take, live, colour)
            self._send_soon(hello)
        self._send_soon({"type": "progress", "text": "", "share": 1.0})
        self._loading = None
        self._wake.set()

    def _take(self, live: LiveCloud, colour: ColourBy | None) -> dict[str, Any]:
        """Give the cloud to the session, in a thread; return what is told of it."""
        with self._turns.turn():
            self._session.take(live, colour)
            return greeting(self._session)

    def _tell_progress(self, text: str, share: float | None) -> None:
        """Tell the client how far long work is; its end is told elsewhere."""
        self._send_soon({"type": "progress", "text": text, "share": share and min(share, 0.99)})

    def _tell_from_thread(self, text: str, share: float | None) -> None:
        """Tell the client how far the session's work is, from a thread."""
        now = time.perf_counter()
        if share == 1.0 or now - self._told_at >= EVERY:
            self._told_at = now
            message = {"type": "progress", "text": text, "share": share}
            self._loop.call_soon_threadsafe(self._send_soon, message)

    def _send_soon(self, message: dict[str, Any]) -> None:
        """Send a message before long."""
        self._messages.put_nowait(message)

    async def _tell(self) -> None:
        """Send messages that came from elsewhere than drawing."""
        while True:
            await self._send(await self._messages.get())

    async def _send(self, message: bytes | dict[str, Any]) -> None:
        """Send a message."""
        if isinstance(message, bytes):
            await self._socket.send_bytes(message)
        else:
            await self._socket.send_json(message)
