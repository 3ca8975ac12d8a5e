"""A page without a browser: turns a live view's cloud, and times the pictures that it gets."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import aiohttp
from yarl import URL

from splatline.view.server.protocol import HEADER, PICTURE, REFINED

__all__ = ["Arrivals", "Page", "open_page"]

PATIENCE = 60.0
"""Seconds after which a server that sends nothing has failed."""

EVENT_PERIOD = 1.0 / 125.0
"""Seconds between two positions of a mouse."""

STEP = 2.0
"""Pixels that a mouse moves in that time."""


@dataclass
class Arrivals:
    """Pictures that arrived: when, and the width of each."""

    times: list[float] = field(default_factory=list)
    widths: list[int] = field(default_factory=list)


class Page:
    """A connection to a live view.

    Parameters
    ----------
    socket
        The WebSocket, open.
    """

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self._socket = socket

    async def start(self, size: tuple[int, int]) -> None:
        """Ask for a size and wait for the first refined picture."""
        await self._send("resize", width=size[0], height=size[1])
        await self._until_refined()

    async def turn(self, seconds: float) -> Arrivals:
        """Move the mouse for some seconds; return the pictures that arrived meanwhile."""
        arrivals = Arrivals()
        await self._send("moving", value=True)
        end = time.perf_counter() + seconds
        mouse = asyncio.create_task(self._mouse())
        while time.perf_counter() < end:
            header = await self._picture()
            arrivals.times.append(time.perf_counter())
            arrivals.widths.append(header[3])
        mouse.cancel()
        await asyncio.gather(mouse, return_exceptions=True)
        await self._send("moving", value=False)
        await self._until_refined()
        return arrivals

    async def steps(self, number: int, pause: float) -> list[float]:
        """Move the mouse by single steps while the button is down; return each picture's latency.

        Latencies are in seconds. The view rests before each step, for ``pause`` seconds.
        """
        latencies = []
        await self._send("moving", value=True)
        for _ in range(number):
            await asyncio.sleep(pause)
            start = time.perf_counter()
            await self._send("turn", dx=STEP, dy=0)
            await self._picture()
            latencies.append(time.perf_counter() - start)
        await self._send("moving", value=False)
        await self._until_refined()
        return latencies

    async def _mouse(self) -> None:
        """Send positions of a mouse until it is cancelled."""
        while True:
            await self._send("turn", dx=STEP, dy=0)
            await asyncio.sleep(EVENT_PERIOD)

    async def _picture(self) -> tuple[int, ...]:
        """Return the header of the next picture, and acknowledge it."""
        while True:
            message = await self._socket.receive(PATIENCE)
            if message.type is aiohttp.WSMsgType.BINARY:
                header: tuple[int, ...] = HEADER.unpack_from(message.data)
                if header[1] == PICTURE:
                    await self._send("shown", frame=header[2])
                    return header
            elif message.type is not aiohttp.WSMsgType.TEXT:
                raise ConnectionError("the live view ended")
            elif '"error"' in message.data:
                raise ConnectionError(message.data)

    async def _until_refined(self) -> None:
        """Wait for a refined picture."""
        while not (await self._picture())[6] & REFINED:
            pass

    async def _send(self, kind: str, **values: Any) -> None:
        """Send a message."""
        await self._socket.send_json({"type": kind, **values})


async def open_page(address: str, use: Callable[[Page], Any]) -> Any:
    """Open an address that ``splatline view`` printed, and return what ``use`` makes of it."""
    url = URL(address)
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(
            url.with_path("/socket").with_query(token=url.query["token"]),
            origin=str(url.origin()),
            max_msg_size=0,
        ) as socket,
    ):
        return await use(Page(socket))
