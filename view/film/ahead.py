"""Values that threads make ahead of their use, in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import numba

__all__ = ["ahead"]

_In = TypeVar("_In")
_Out = TypeVar("_Out")


def ahead(make: Callable[[_In], _Out], sources: Iterable[_In]) -> Generator[_Out]:
    """Yield what is made of each source, in their order, while threads make those to come.

    There is a thread for each core. Each makes a value by itself: numba's functions release
    Python's lock, and use one core in such a thread. Two values for each thread are made or wait
    at most.

    An exception of a thread is raised here, in its turn. When the generator is closed, the threads
    end after the values that they are making.

    Parameters
    ----------
    make
        Makes a value; several threads call it at once.
    sources
        What the values are made of.
    """
    threads = numba.get_num_threads()
    waiting: deque[Future[_Out]] = deque()
    pool = ThreadPoolExecutor(threads, "splatline-ahead", numba.set_num_threads, (1,))
    try:
        for source in sources:
            waiting.append(pool.submit(make, source))
            if len(waiting) == 2 * threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
