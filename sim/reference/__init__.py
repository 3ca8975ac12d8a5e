"""Exact and point-sampled renderers, and measures of a picture's error against them.

It imports ``contract``, ``host`` and ``sim.golden``. Start with ``reference``.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {
    "Reference": "reference",
    "bound_disc": "reference_kernel",
    "bound_part": "reference_kernel",
    "render": "reference",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that importing the package costs nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
