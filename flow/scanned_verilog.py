"""The Verilog of tops on AXI behind a scan chain, to measure their clock rate."""

from __future__ import annotations

from amaranth.lib.wiring import In

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.rtl.bus.axi_top import AxiTop
from splatline.rtl.bus.scan_top import ScanTop
from splatline.rtl.framebuffer.top import FrameBufferTop

from .verilog import convert, describe, header

__all__ = ["generate_scanned_axi", "generate_scanned_framebuffer"]


def generate_scanned_axi(
    config: EngineConfig = PAPER, name: str = "splatline", progress: Share | None = None
) -> tuple[str, dict]:
    """Return the Verilog and the description of an engine in the AXI top behind a scan chain.

    Parameters and results are those of :func:`splatline.flow.verilog.generate`.
    """
    return _generate(AxiTop(config), name, progress)


def generate_scanned_framebuffer(
    config: EngineConfig = PAPER, name: str = "splatline", progress: Share | None = None
) -> tuple[str, dict]:
    """Return the same of the frame buffer top, with 64 bits to memory."""
    return _generate(FrameBufferTop(config), name, progress)


def _generate(inner: AxiTop, name: str, progress: Share | None) -> tuple[str, dict]:
    top = ScanTop(inner)
    ports = [
        {"name": port, "direction": "input" if member.flow is In else "output", "width": 1}
        for port, member in top.signature.members.items()
    ]
    return header(inner.config) + convert(top, name, progress), describe(top, name, ports=ports)
