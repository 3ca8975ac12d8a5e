"""Progress of a task whose parts tell shares of their own."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["Share", "part_of"]

Share = Callable[[float], None]
"""Called with the share of a task that is done, 0 to 1."""


def part_of(progress: Share | None, first: float, last: float) -> Share | None:
    """Return what tells the share of a part, from ``first`` to ``last`` of the whole.

    It is None if ``progress`` is, as nobody wants to know.
    """
    if progress is None:
        return None
    return lambda share: progress(first + (last - first) * share)
