"""Cosimulation: cocotb drives the generated Verilog in Verilator or Icarus.

It imports ``contract``, ``rtl``, ``flow``, ``host`` and ``sim``; cocotb is an extra. Start with
``simulator``.
"""

from __future__ import annotations

import importlib
from typing import Any

_HOMES = {
    "SimulatedDevice": "axi.axi_device",
    "simulate_frame": "player.frames",
}

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    """Import a public name on first use, so that importing the package costs nothing."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
