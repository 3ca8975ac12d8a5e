"""Cosimulation: cocotb drives the generated Verilog in Verilator or Icarus."""

from __future__ import annotations

import importlib
from types import ModuleType

__all__ = ["axi_device", "axi_frames", "blocks", "chains", "frames", "jobs", "simulator", "streams"]


def __getattr__(name: str) -> ModuleType:
    """Import a module on first use: cocotb and its peers are an extra."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module(f".{name}", __name__)
