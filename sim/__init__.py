"""Simulation: the golden renderer, the exact reference, metrics and cosimulation."""

from __future__ import annotations

import importlib
from types import ModuleType

__all__ = ["beats", "cosim", "figure", "golden", "metrics", "raster", "reference"]


def __getattr__(name: str) -> ModuleType:
    """Import a module on first use, so that importing the package costs nothing."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f".{name}", __name__)
