"""How far a build or a run is, told by a thread while the tools work."""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Callable, Iterator

__all__ = ["Progress", "share_of", "watched"]

Progress = Callable[[str, float], None]
"""Called with ``build`` or ``run`` and the share of it that is done, from any thread."""

LOOK = 0.2
"""Seconds between two looks."""


def share_of(progress: Progress | None, stage: str) -> Callable[[float], None] | None:
    """Return what tells the share of one stage; None if nobody wants to know."""
    return None if progress is None else functools.partial(progress, stage)


@contextlib.contextmanager
def watched(share: Callable[[], float], progress: Callable[[float], None] | None) -> Iterator[None]:
    """Tell a share now and then while the block runs.

    Parameters
    ----------
    share
        Returns the share that is done, 0 to 1. It may raise ``OSError`` or ``ValueError`` while
        what it reads is not there yet, or is being written.
    progress
        Called with the share; None: nothing is told.
    """
    if progress is None:
        yield
        return
    ended = threading.Event()

    def look() -> None:
        while not ended.wait(LOOK):
            with contextlib.suppress(OSError, ValueError):
                progress(min(1.0, share()))

    watcher = threading.Thread(target=look, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
