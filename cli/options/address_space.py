"""A check of ``ulimit -v`` before libraries are loaded that hang or abort where it is too low."""

from __future__ import annotations

import os
import sys

from splatline.contract.errors import InputError

__all__ = ["check_address_space"]

LIBRARIES = 450 << 20
"""Bytes of address space that numba, numpy and scipy take, without their threads."""

A_CORE = 100 << 20
"""Bytes that the threads of a core take: 32 MB for each of two OpenBLAS, and their stacks."""


def check_address_space() -> None:
    """Raise ``InputError`` if a limit leaves no room for the libraries that draw.

    Where they are loaded, there is room.
    """
    from splatline.host.files.available_memory import address_space_left

    room = None if "numba" in sys.modules else address_space_left()
    need = LIBRARIES + A_CORE * len(os.sched_getaffinity(0))
    if room is not None and room < need:
        raise InputError(
            f"the limit of address space leaves {room >> 20:,} MB, and the libraries that draw"
            f" take {need >> 20:,} MB; raise it, with 'ulimit -v unlimited' for example"
        )
