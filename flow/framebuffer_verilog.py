"""The Verilog of the frame buffer top, and its description."""

from __future__ import annotations

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.contract.progress import Share
from splatline.rtl.framebuffer.top import FrameBufferTop

from .axi_verilog import MEANINGS as AXI_MEANINGS
from .axi_verilog import describe_axi
from .verilog import convert, header

__all__ = ["generate_framebuffer"]

MEANINGS = {
    **AXI_MEANINGS,
    "m_axi": "AXI4, write channels: the memory of the frame buffers",
    "buffer_0": "address of frame buffer 0",
    "buffer_1": "address of frame buffer 1",
    "stride": "bytes from a line to the next one",
    "background": "colour of the background: red in bits 0..7, then green, then blue",
    "swap_valid": "the picture in buffer swap_index is whole, and waits for swapped",
    "swap_index": "the buffer that is drawn into, or waits for swapped",
    "swapped": "one cycle: the display shows buffer swap_index from now on",
    "writer_error": "a response of the memory was an error; high until the reset",
}


def generate_framebuffer(
    config: EngineConfig = PAPER,
    name: str = "splatline",
    progress: Share | None = None,
    *,
    data_bits: int = 64,
) -> tuple[str, dict]:
    """Return the Verilog and the description of an engine in the frame buffer top.

    Parameters and results are those of :func:`splatline.flow.axi_verilog.generate_axi`;
    ``data_bits`` is the width of the memory's bus. The description also has ``framebuffer``: that
    width, the most beats of a burst, and the most bursts without a response.
    """
    top = FrameBufferTop(config, data_bits)
    writer = top.writer.writer
    return header(config) + convert(top, name, progress), {
        **describe_axi(top, name, MEANINGS),
        "framebuffer": {
            "data_bits": writer.data_bits,
            "burst": writer.burst,
            "outstanding": writer.outstanding,
        },
    }
