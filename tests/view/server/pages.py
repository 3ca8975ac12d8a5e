"""A live view's server within a test, and a client of it."""

import asyncio
import contextlib
import json

import aiohttp
from yarl import URL

from splatline.view.choices import Choices
from splatline.view.server.protocol import HEADER
from splatline.view.server.run import running

__all__ = ["Client", "client", "serve"]


def serve(subject, use, choices=None):
    """Serve a subject while a coroutine uses its address; return what that returns."""

    async def serving():
        async with running(subject, choices or Choices()) as address:
            return await asyncio.wait_for(use(URL(address)), 60)

    return asyncio.run(serving())


class Client:
    """A page: sends messages, and returns what comes."""

    def __init__(self, socket):
        self.socket = socket
        self.acknowledges = True

    async def send(self, kind, **values):
        await self.socket.send_json({"type": kind, **values})

    async def next(self):
        """Return the next message: a dict, or a header with the payload."""
        message = await self.socket.receive(10)
        if message.type is aiohttp.WSMsgType.TEXT:
            return json.loads(message.data)
        assert message.type is aiohttp.WSMsgType.BINARY, message
        header = HEADER.unpack_from(message.data)
        if header[1] == 1 and self.acknowledges:
            await self.send("shown", frame=header[2])
        return header, message.data[HEADER.size :]

    async def until(self, wanted):
        """Return the first message that is wanted."""
        while True:
            message = await self.next()
            if wanted(message):
                return message

    async def message(self, kind):
        """Return the next text message of a type."""
        return await self.until(lambda each: isinstance(each, dict) and each["type"] == kind)

    async def picture(self, *, refined=False):
        """Return the next picture."""
        return await self.until(
            lambda each: isinstance(each, tuple) and (each[0][6] & 1 or not refined)
        )


@contextlib.asynccontextmanager
async def client(address, **options):
    """Open a page at an address."""
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(
            address.with_path("/socket").with_query(token=address.query["token"]),
            **{"origin": str(address.origin()), "max_msg_size": 0, **options},
        ) as socket,
    ):
        yield Client(socket)
