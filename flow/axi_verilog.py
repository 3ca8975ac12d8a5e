"""The Verilog of the AXI top, and its description."""

from __future__ import annotations

from amaranth.hdl import Shape
from amaranth.lib.wiring import In

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.rtl.bus.axi_top import AxiTop

from .register_texts import json_map
from .verilog import convert, describe, header

__all__ = ["MEANINGS", "describe_axi", "generate_axi"]

MEANINGS = {
    "aclk": "clock of all buses, rising edge",
    "aresetn": "synchronous reset, active low",
    "irq": "interrupt, high until its cause is cleared",
    "s_axi_ctrl": "AXI4-Lite: the registers",
    "s_axis_codewords": "AXI4-Stream: a packet is the code words of a frame",
    "s_axis_initial": "AXI4-Stream: a packet is the raster that a frame starts from",
    "m_axis_raster": "AXI4-Stream: a packet is the picture of a frame",
}


def generate_axi(
    config: EngineConfig = PAPER, name: str = "splatline", progress: Share | None = None
) -> tuple[str, dict]:
    """Return the Verilog and the description of an engine in the AXI top.

    Parameters and results are those of :func:`splatline.flow.verilog.generate`. The description
    also has the register map.
    """
    top = AxiTop(config)
    return header(config) + convert(top, name, progress), describe_axi(top, name, MEANINGS)


def describe_axi(top: AxiTop, name: str, meanings: dict[str, str]) -> dict:
    """Return the description of a top on AXI, with its registers.

    ``meanings`` has the meaning of each bus and wire, by name.
    """
    ports = []
    for port, member in top.signature.members.items():
        bus = next((bus for bus in top.buses if port.startswith(f"{bus}_")), port)
        ports.append(
            {
                "name": port,
                "direction": "input" if member.flow is In else "output",
                "width": Shape.cast(member.shape).width,
                "meaning": meanings[bus],
            }
        )
    return {**describe(top, name, ports=ports), "registers": json_map(top.registers)}
