"""The golden renderer: the contract in software, bit for bit.

It imports ``contract`` and ``host``. Start with ``renderer``.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {
    "block_rows": "renderer",
    "decode": "renderer",
    "render": "renderer",
    "render_parts": "renderer",
    "Average": "multisample",
    "Drawn": "multisample",
    "average": "multisample",
    "mismatches": "multisample",
    "Expansion": "compact_words",
    "expand": "compact_words",
    "expand_frame": "compact_words",
    "slots": "compact_words",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that importing the package costs nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
