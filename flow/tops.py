"""The top modules that an engine is written with, by name."""

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
"""``engine``: whole streams; ``pins``: narrow ones, which fit a package; ``axi``: vendors' buses.

Each is a function of a configuration and a module's name; it returns the Verilog and its
description.
"""
