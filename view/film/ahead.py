"""Values that a thread makes ahead of their use."""

from __future__ import annotations

import queue
import threading
from collections.abc import Generator, Iterable
from typing import TypeVar

__all__ = ["ahead"]

_T = TypeVar("_T")


def ahead(values: Iterable[_T], most: int = 2) -> Generator[_T]:
    """Yield values, which a thread makes while the caller uses those before.

    At most ``most`` values wait. An exception of the thread is raised here, in its turn. When the
    generator is closed, the thread ends after the value that it is making.

    Parameters
    ----------
    values
        What the thread goes through.
    most
        Values that may wait.
    """
    waiting: queue.Queue[tuple[bool, _T | BaseException | None]] = queue.Queue(most)
    closed = threading.Event()

    def put(is_value: bool, what: _T | BaseException | None) -> None:
        while not closed.is_set():
            try:
                waiting.put((is_value, what), timeout=0.1)
            except queue.Full:
                continue
            return

    def make() -> None:
        try:
            for value in values:
                put(True, value)
                if closed.is_set():
                    return
        except BaseException as error:  # raised in the caller
            put(False, error)
        else:
            put(False, None)

    thread = threading.Thread(target=make, name="splatline-ahead", daemon=True)
    thread.start()
    try:
        while True:
            is_value, what = waiting.get()
            if is_value:
                yield what  # type: ignore[misc]
            elif isinstance(what, BaseException):
                raise what
            else:
                return
    finally:
        closed.set()
        thread.join()
