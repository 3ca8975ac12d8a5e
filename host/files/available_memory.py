"""The memory that this process may still take."""

from __future__ import annotations

import resource
from pathlib import Path

__all__ = ["address_space_left", "available_memory"]


def available_memory() -> int | None:
    """Return the bytes that can be taken: the machine's, or fewer if a limit is set; None: unknown.

    ``/proc`` tells what the machine has, and how much this process has of what ``ulimit -v``
    limits.
    """
    least = []
    try:
        facts = dict(line.split(":", 1) for line in Path("/proc/meminfo").read_text().splitlines())
        least.append(1024 * int(facts["MemAvailable"].split()[0]))
    except (OSError, KeyError, ValueError):  # no Linux
        pass
    room = address_space_left()
    return min([*least, *([] if room is None else [room])], default=None)


def address_space_left() -> int | None:
    """Return the bytes that ``ulimit -v`` still allows; None: it has no limit, or it is unknown."""
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return None
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (OSError, ValueError):  # no Linux
        return None
    return max(0, limit - pages * resource.getpagesize())
