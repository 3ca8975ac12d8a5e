"""Simulation: the golden renderer, the exact reference, cycle models and cosimulation.

It imports ``contract`` and ``host``; ``cosim`` alone imports ``rtl`` and ``flow``. Start with
``golden``.
"""

from __future__ import annotations

import importlib
from types import ModuleType

__all__ = ["cosim", "cycles", "golden", "reference", "stress"]


def __getattr__(name: str) -> ModuleType:
    """Import a package on first use, so that importing this one costs nothing."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f".{name}", __name__)
