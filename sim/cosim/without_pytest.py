"""Start of cocotb in a simulator's process without pytest, which takes half of the time.

cocotb imports pytest for the exceptions of its outcomes, and to rewrite assertions. A module that
neither raises these nor has assertions to rewrite does not need it.
"""

from __future__ import annotations

import os
import sys
from types import ModuleType, SimpleNamespace

__all__ = ["ENTRY", "REWRITTEN", "VARIABLE", "start"]

REWRITTEN = "COCOTB_REWRITE_ASSERTION_FILES"
"""cocotb's variable with patterns of files whose assertions pytest rewrites, to show values."""

VARIABLE = "PYGPI_USERS"
"""cocotb's variable with the function that starts it in the simulator."""

ENTRY = f"{__name__}:start"
"""Its value for :func:`start`."""


class NeverRaisedError(Exception):
    """An outcome of pytest's."""


def start() -> None:
    """Start cocotb as it starts by itself, but with an empty module in pytest's place."""
    outcome = SimpleNamespace(Exception=NeverRaisedError)
    _replace("pytest", raises=outcome, skip=outcome, xfail=outcome)
    _replace("_pytest.assertion", install_importhook=None)
    _replace("_pytest.config", Config=None)
    os.environ[REWRITTEN] = ""
    del os.environ[VARIABLE]
    from pygpi.entry import load_entry

    load_entry()


def _replace(name: str, **contents: object) -> None:
    """Put a module with some contents in a module's place."""
    module = ModuleType(name)
    vars(module).update(contents)
    sys.modules[name] = module
