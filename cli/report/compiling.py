"""Tells on standard error that functions are being compiled, which happens once on a machine."""

from __future__ import annotations

import sys
import time
from typing import Any

from .numba_import import import_numba

__all__ = ["LINE", "tell_compiling"]

LINE = "Compiling, once on this machine (half a minute) ..."

SOON = 1.0
"""Seconds of compiling before it is told. A kind of file may need a small function more."""

FUNCTIONS = 240
"""How many a first picture compiles, with those within them."""

_told = False


def tell_compiling() -> None:
    """Have a line printed if numba compiles for more than ``SOON`` seconds, once a process.

    A line for each quarter of ``FUNCTIONS`` follows. Numba tells when it compiles; what it loads
    from its cache is no such event.
    """
    global _told
    if _told:
        return
    _told = True
    import_numba()
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        def __init__(self) -> None:
            self.inside = self.compiled = 0
            self.begun = self.spent = 0.0
            self.said = False

        def on_start(self, event: Any) -> None:
            now = time.monotonic()
            if not self.inside:
                self.begun = now
            self.inside += 1  # functions that are called are compiled within
            if not self.said and self.spent + now - self.begun > SOON:
                self.said = True
                print(LINE, file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:
            self.inside -= 1
            self.compiled += 1
            quarters, rest = divmod(4 * self.compiled, FUNCTIONS)
            if self.said and rest < 4 and quarters < 4:
                print(f" {25 * quarters} %  Compiling ...", file=sys.stderr, flush=True)
            if not self.inside:
                self.spent += time.monotonic() - self.begun

    event.register("numba:compile", Listener())
