"""The engine with its frame buffer as a LiteX core."""

from __future__ import annotations

from litedram.frontend.axi import LiteDRAMAXI2Native, LiteDRAMAXIPort
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from litex.soc.interconnect.axi import AXILiteInterface
from litex.soc.interconnect.csr import CSRStatus
from migen import ClockSignal, If, Instance, ResetSignal, Signal

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.register_map import register_map

__all__ = ["MODULE", "EngineCore"]

MODULE = "splatline"
"""Name of the engine's Verilog module."""


class EngineCore(LiteXModule):
    """``FrameBufferTop``: code words in, a picture in one of two buffers out.

    An initial raster is not used: its port is idle.

    Parameters
    ----------
    config
        The engine's configuration.
    port
        A LiteDRAM port for writes, of 32 bits.
    scanout
        Has the addresses, the stride and the background in registers.

    Attributes
    ----------
    bus
        AXI4-Lite: the registers.
    codewords
        Stream in: ``data`` of 64 bits, or 128 with planes, and ``last`` with the end word.
    swap_valid, swap_index : out
        A whole frame is in the buffer of this index.
    swapped : in
        It is shown now.
    pause : in
        No further burst begins.
    """

    def __init__(self, config: EngineConfig, port, scanout):
        bits = register_map(config).address_bits
        word_bytes, beat_bytes = codeword_stream_bytes(config), raster_stream_bytes(config)
        self.bus = AXILiteInterface(data_width=32, address_width=32)
        self.codewords = stream.Endpoint([("data", 8 * word_bytes)])
        self.swap_valid = Signal()
        self.swap_index = Signal()
        self.swapped = Signal()
        self.pause = Signal()
        self.writer_error = CSRStatus(1, description="a write to SDRAM failed, since reset")

        # # #

        memory = LiteDRAMAXIPort(data_width=32, address_width=32, id_width=1)
        self.to_memory = LiteDRAMAXI2Native(memory, port)
        failed, address_valid = Signal(), Signal()
        self.comb += memory.aw.valid.eq(address_valid & ~self.pause)
        self.sync += If(failed, self.writer_error.status.eq(1))
        self.specials += Instance(
            MODULE,
            i_aclk=ClockSignal(),
            i_aresetn=~ResetSignal(),
            i_s_axis_codewords_tdata=self.codewords.data,
            i_s_axis_codewords_tkeep=(1 << word_bytes) - 1,
            i_s_axis_codewords_tlast=self.codewords.last,
            i_s_axis_codewords_tvalid=self.codewords.valid,
            o_s_axis_codewords_tready=self.codewords.ready,
            i_s_axis_initial_tdata=Signal(8 * beat_bytes),
            i_s_axis_initial_tkeep=(1 << beat_bytes) - 1,
            i_s_axis_initial_tlast=0,
            i_s_axis_initial_tvalid=0,
            i_buffer_0=scanout.buffer_0.storage,
            i_buffer_1=scanout.buffer_1.storage,
            i_stride=scanout.stride.storage[:16],
            i_background=scanout.background.storage,
            o_swap_valid=self.swap_valid,
            o_swap_index=self.swap_index,
            i_swapped=self.swapped,
            o_writer_error=failed,
            **_lite(self.bus, bits),
            **_write_master(memory),
            o_m_axi_awvalid=address_valid,
            i_m_axi_awready=memory.aw.ready & ~self.pause,
        )


def _lite(bus: AXILiteInterface, bits: int) -> dict:
    """Return the connections of the AXI4-Lite port."""
    wires = {}
    for name in ("aw", "w", "ar"):
        channel = getattr(bus, name)
        wires[f"i_s_axi_ctrl_{name}valid"] = channel.valid
        wires[f"o_s_axi_ctrl_{name}ready"] = channel.ready
    for name in ("b", "r"):
        channel = getattr(bus, name)
        wires[f"o_s_axi_ctrl_{name}valid"] = channel.valid
        wires[f"i_s_axi_ctrl_{name}ready"] = channel.ready
        wires[f"o_s_axi_ctrl_{name}resp"] = channel.resp
    return wires | {
        "i_s_axi_ctrl_awaddr": bus.aw.addr[:bits],
        "i_s_axi_ctrl_awprot": 0,
        "i_s_axi_ctrl_wdata": bus.w.data,
        "i_s_axi_ctrl_wstrb": bus.w.strb,
        "i_s_axi_ctrl_araddr": bus.ar.addr[:bits],
        "i_s_axi_ctrl_arprot": 0,
        "o_s_axi_ctrl_rdata": bus.r.data,
    }


def _write_master(bus: LiteDRAMAXIPort) -> dict:
    """Return the connections of the AXI4 port that writes the picture, but for AW's handshake."""
    return {
        "o_m_axi_awaddr": bus.aw.addr,
        "o_m_axi_awlen": bus.aw.len,
        "o_m_axi_awsize": bus.aw.size,
        "o_m_axi_awburst": bus.aw.burst,
        "o_m_axi_wdata": bus.w.data,
        "o_m_axi_wstrb": bus.w.strb,
        "o_m_axi_wlast": bus.w.last,
        "o_m_axi_wvalid": bus.w.valid,
        "i_m_axi_wready": bus.w.ready,
        "i_m_axi_bid": 0,
        "i_m_axi_bresp": bus.b.resp,
        "i_m_axi_bvalid": bus.b.valid,
        "o_m_axi_bready": bus.b.ready,
    }
