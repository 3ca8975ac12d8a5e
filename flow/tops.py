"""The top modules of an engine, by name."""

from __future__ import annotations

from collections.abc import Callable

from .axi_verilog import generate_axi
from .framebuffer_verilog import generate_framebuffer
from .narrow_verilog import generate_pins
from .verilog import generate

__all__ = ["TOPS"]

TOPS: dict[str, Callable[..., tuple[str, dict]]] = {
    "engine": generate,
    "pins": generate_pins,
    "axi": generate_axi,
    "framebuffer": generate_framebuffer,
}
"""``engine``: the engine's own streams; ``pins``: the narrow top; ``axi``: the AXI top;
``framebuffer``: the AXI top that writes its pictures to memory.

Each is a function with the parameters of :func:`splatline.flow.verilog.generate`. It returns the
Verilog and its description.
"""
