"""The web application: its addresses, and who may use them."""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Awaitable, Callable
from concurrent.futures import Executor
from urllib.parse import urlsplit

from aiohttp import WSCloseCode, web

from splatline.view.session import Session

from .library import Library
from .pages import HEADERS, INDEX, PageFile, page_files
from .protocol import LARGEST_FRAME
from .tab import Tab
from .turns import Turns

__all__ = ["Viewer", "is_loopback"]

MOST_TABS = 16
"""Tabs that are served at once."""

HEARTBEAT = 30.0
"""Seconds between two pings of a tab."""


def is_loopback(host: str) -> bool:
    """Return whether a name or an address is this machine's own."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


class Viewer:
    """The application of a live view.

    Parameters
    ----------
    token
        What every address needs.
    host
        The address that is served.
    new_session
        Makes the session of a tab.
    library, executor, turns
        Where clouds are read and drawn.
    """

    def __init__(
        self,
        token: str,
        host: str,
        new_session: Callable[[], Session],
        library: Library,
        executor: Executor,
        turns: Turns,
    ) -> None:
        self._token = token.encode()
        self._host = host
        self._new_session = new_session
        self._library = library
        self._executor = executor
        self._turns = turns
        self._files = page_files()
        self._sockets: set[web.WebSocketResponse] = set()

    def application(self) -> web.Application:
        """Return the application."""
        app = web.Application(middlewares=[self._guard])
        app.router.add_get("/", self._index)
        app.router.add_get("/page/{name}", self._file)
        app.router.add_get("/socket", self._socket)
        app.on_shutdown.append(self._close)
        return app

    @web.middleware
    async def _guard(
        self, request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        """Refuse what is asked of another name, and set the headers of every answer."""
        try:
            if is_loopback(self._host) and not is_loopback(_hostname(request.host)):
                # A name elsewhere that is resolved to this machine must not read the page.
                raise web.HTTPForbidden(text="this address is not served\n")
            response = await handler(request)
        except web.HTTPException as error:
            error.headers.update(HEADERS)
            raise
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    def _check_token(self, request: web.Request) -> None:
        """Refuse a request without the token."""
        given = request.query.get("token", "").encode(errors="replace")
        if not hmac.compare_digest(given, self._token):
            raise web.HTTPForbidden(
                text="the token in the address is missing or wrong; use the address that"
                " `splatline view` printed\n"
            )

    async def _index(self, request: web.Request) -> web.StreamResponse:
        """Return the page."""
        self._check_token(request)
        return self._answer(self._files.get(INDEX))

    async def _file(self, request: web.Request) -> web.StreamResponse:
        """Return a file of the page."""
        return self._answer(self._files.get(request.match_info["name"]))

    def _answer(self, file: PageFile | None) -> web.StreamResponse:
        """Return a file, or 404."""
        if file is None:
            raise web.HTTPNotFound(text="there is no such file\n")
        return web.Response(body=file.data, content_type=file.mime)

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        """Serve a tab."""
        self._check_token(request)
        if request.headers.get("Origin") != f"{request.scheme}://{request.host}":
            raise web.HTTPForbidden(text="the page is of another origin\n")
        if len(self._sockets) >= MOST_TABS:
            raise web.HTTPServiceUnavailable(text=f"{MOST_TABS} tabs are open; close one\n")
        socket = web.WebSocketResponse(
            max_msg_size=LARGEST_FRAME, compress=False, heartbeat=HEARTBEAT
        )
        await socket.prepare(request)
        self._sockets.add(socket)
        try:
            session = self._new_session()
            png = not is_loopback(request.remote or "")
            tab = Tab(socket, session, self._library, self._executor, self._turns, png=png)
            await tab.serve()
        finally:
            self._sockets.discard(socket)
            await socket.close()
        return socket

    async def _close(self, app: web.Application) -> None:
        """Close all tabs."""
        for socket in tuple(self._sockets):
            await socket.close(code=WSCloseCode.GOING_AWAY, message=b"the server ends")


def _hostname(host: str) -> str:
    """Return the name of a ``Host`` header without its port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""
