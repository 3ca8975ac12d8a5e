"""Serves a live view until Ctrl-C."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import signal
import threading
import webbrowser
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor

from aiohttp import web

from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.choices import Choices
from splatline.view.session import Session
from splatline.view.subject import Subject

from .app import MOST_TABS, Viewer
from .library import Library
from .turns import Turns

__all__ = ["running", "serve"]

LAST_ANSWERS = 1.0
"""Seconds that open connections have when the server ends."""


def serve(
    subject: Subject,
    choices: Choices,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    browser: bool = True,
    announce: Callable[[str], None] = print,
) -> None:
    """Serve a live view until SIGINT or SIGTERM.

    Parameters
    ----------
    subject, choices
        The first picture of each tab.
    host, port
        The address; port 0 is a free one.
    browser
        Whether the browser is opened.
    announce
        Told the address with the token.

    Raises
    ------
    InputError
        If the address cannot be served.
    """
    asyncio.run(_serve(subject, choices, host, port, browser, announce))


async def _serve(
    subject: Subject,
    choices: Choices,
    host: str,
    port: int,
    browser: bool,
    announce: Callable[[str], None],
) -> None:
    """Serve a live view; see :func:`serve`."""
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stopped.set)
    async with running(subject, choices, host=host, port=port) as address:
        announce(address)
        if browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
        await stopped.wait()


@contextlib.asynccontextmanager
async def running(
    subject: Subject, choices: Choices, *, host: str = "127.0.0.1", port: int = 0
) -> AsyncIterator[str]:
    """Serve a live view within the block; yields the address with its token.

    Raises
    ------
    InputError
        If the address cannot be served.
    """
    executor = ThreadPoolExecutor(2 * MOST_TABS, "splatline-view")
    turns = Turns()
    library = Library(subject, choices.settings.preset, executor, turns)
    token = secrets.token_urlsafe()
    viewer = Viewer(token, host, lambda: Session(subject, choices), library, executor, turns)
    runner = web.AppRunner(viewer.application(), access_log=None, shutdown_timeout=LAST_ANSWERS)
    await runner.setup()
    reading = None
    try:
        try:
            await web.TCPSite(runner, host, port).start()
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(f"{host}:{port} cannot be served: {reason}") from None
        reading = asyncio.create_task(_read_ahead(library, choices.colour))
        yield _address(host, runner.addresses[0][1], token)
    finally:
        library.stop()
        if reading is not None:
            reading.cancel()
        await runner.cleanup()
        await asyncio.to_thread(executor.shutdown, cancel_futures=True)


async def _read_ahead(library: Library, colour: ColourBy | None) -> None:
    """Read the cloud while the browser starts; the page tells what goes wrong."""
    with contextlib.suppress(InputError):
        await library.get(colour, lambda text, share: None)


def _address(host: str, port: int, token: str) -> str:
    """Return the address of the page."""
    named = f"[{host}]" if ":" in host else host
    return f"http://{named}:{port}/?token={token}"
