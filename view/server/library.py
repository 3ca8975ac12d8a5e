"""Clouds that tabs share: each is read once for each choice of colours."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections import OrderedDict
from concurrent.futures import Executor

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError
from splatline.host.files.wanted import ColourBy
from splatline.view.live_cloud import LiveCloud
from splatline.view.outputs import Superseded, Tell
from splatline.view.subject import Subject

from .turns import Turns

__all__ = ["EVERY", "Library"]

MOST_KEPT = 3
"""Choices of colours that are kept; tabs hold their own as well."""

EVERY = 0.1
"""Seconds between two tellings of a share."""


class Library:
    """The clouds of a subject.

    Parameters
    ----------
    subject
        What is read.
    config
        The engine whose index is built at once.
    executor, turns
        Where it is read.
    """

    def __init__(
        self, subject: Subject, config: EngineConfig, executor: Executor, turns: Turns
    ) -> None:
        self._subject = subject
        self._config = config
        self._executor = executor
        self._turns = turns
        self._tasks: OrderedDict[ColourBy | None, asyncio.Future[LiveCloud]] = OrderedDict()
        self._listeners: dict[ColourBy | None, set[Tell]] = {}
        self._base: LiveCloud | None = None
        self._stopped = threading.Event()

    async def get(self, colour: ColourBy | None, tell: Tell) -> LiveCloud:
        """Return the cloud in some colours; it is read if no tab has it.

        Raises
        ------
        InputError
            If it cannot be read so.
        """
        task = self._tasks.get(colour)
        if task is None or (task.done() and task.exception() is not None):
            task = self._begin(colour)
        self._tasks.move_to_end(colour)
        listeners = self._listeners.setdefault(colour, set())
        listeners.add(tell)
        try:
            return await asyncio.shield(task)
        finally:
            listeners.discard(tell)

    def stop(self) -> None:
        """End what is being read, soon."""
        self._stopped.set()

    def _begin(self, colour: ColourBy | None) -> asyncio.Future[LiveCloud]:
        """Begin to read the cloud in some colours."""
        loop = asyncio.get_running_loop()
        task = loop.run_in_executor(self._executor, self._read, colour, loop)
        task.add_done_callback(lambda done: done.cancelled() or done.exception())
        self._tasks[colour] = task
        while len(self._tasks) > MOST_KEPT:
            self._tasks.popitem(last=False)
        return task

    def _read(self, colour: ColourBy | None, loop: asyncio.AbstractEventLoop) -> LiveCloud:
        """Read the cloud, in a thread; others may draw in between."""
        last_text, last_time = "", -1.0

        def progress(text: str, share: float | None) -> None:
            nonlocal last_text, last_time
            if self._stopped.is_set():
                raise Superseded
            self._turns.pass_on()
            now = time.perf_counter()
            if text != last_text or now - last_time >= EVERY:
                last_text, last_time = text, now
                loop.call_soon_threadsafe(self._tell, colour, text, share)

        try:
            with self._turns.turn():
                live = self._subject.read(colour, progress, self._base)
                progress(f"Indexing {len(live.cloud):,} points", None)
                live.index(self._config, self._subject.upward)
        except (InputError, Superseded):
            raise
        except Exception as error:  # the page must hear of it, whatever it is
            logging.getLogger(__name__).exception("reading %s", self._subject.name)
            reason = str(error) or type(error).__name__
            raise InputError(f"{self._subject.name} cannot be read: {reason}") from error
        self._base = self._base or live
        return live

    def _tell(self, colour: ColourBy | None, text: str, share: float | None) -> None:
        """Tell all who wait for a cloud how far it is."""
        for tell in tuple(self._listeners.get(colour, ())):
            tell(text, share)
