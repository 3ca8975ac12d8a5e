"""The top modules of an engine, by name."""

from __future__ import annotations

from collections.abc import Callable

from splatline.contract.config import EngineConfig

from .axi_verilog import generate_axi
from .narrow_verilog import generate_pins
from .verilog import generate

__all__ = ["TOPS"]

TOPS: dict[str, Callable[[EngineConfig, str], tuple[str, dict]]] = {
    "engine": generate,
    "pins": generate_pins,
    "axi": generate_axi,
}
"""``engine``: the engine's own streams; ``pins``: the narrow top; ``axi``: the AXI top.

Each is a function of a configuration and a module's name. It returns the Verilog and its
description.
"""
