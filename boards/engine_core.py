"""The engine as a LiteX core: it writes its Verilog, and adds it to the platform."""

from __future__ import annotations

from pathlib import Path

from litedram.frontend.axi import LiteDRAMAXI2Native, LiteDRAMAXIPort
from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from litex.soc.interconnect.axi import AXILiteInterface
from litex.soc.interconnect.csr import CSRStatus
from migen import ClockSignal, Constant, If, Instance, ResetSignal, Signal

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.register_map import register_map
from splatline.flow.axi_verilog import generate_axi
from splatline.flow.framebuffer_verilog import generate_framebuffer

__all__ = ["EngineCore"]

FRAME_BUFFER_IN = ("buffer_0", "buffer_1", "stride", "background", "swapped")
FRAME_BUFFER_OUT = ("swap_valid", "swap_index")
"""Wires of the frame buffer top that have the same name here."""


class EngineCore(LiteXModule):
    """An engine for a LiteX SoC: code words in, and a raster or a picture in memory out.

    Without ``port`` it is the AXI top, and the picture leaves on ``raster``. With ``port`` it is
    the frame buffer top, and the picture goes into one of two buffers. Both run in ``sys``.

    It writes its Verilog into the folder ``gateware`` of the platform's output when the SoC is
    finalised. It leaves the bus to the SoC:

    >>> self.engine = EngineCore(platform, RGB24)
    ... self.bus.add_slave(
    ...     "engine", self.engine.bus, SoCRegion(size=self.engine.bus_bytes, cached=False)
    ... )

    Parameters
    ----------
    platform
        The platform of the SoC.
    config
        The engine's configuration.
    port
        A LiteDRAM port for writes, of 32, 64 or 128 bits.
    initial
        Frames may start from a raster on the stream ``initial``.
    name
        Name of the Verilog module and of its file. Engines that differ need names that do.

    Attributes
    ----------
    bus
        AXI4-Lite: the registers (``docs/registers.md``). A SoC puts its own bridge before it.
    bus_bytes
        Bytes that the registers take on the bus.
    codewords
        Stream in: ``data`` of 64 bits, or 128 with planes, and ``last`` with the end word.
    initial
        Stream in, if asked for: ``data`` of a beat, and ``last`` with the end beat.
    raster
        Stream out, without ``port``: as ``initial``.
    irq : out
        The interrupt; high until its cause is cleared.
    buffer_0, buffer_1, stride, background : in
        With ``port``: byte addresses of both buffers, bytes of a line, and red, green and blue.
    swap_valid, swap_index : out
        With ``port``: a whole frame is in the buffer of this index.
    swapped : in
        With ``port``: it is shown now.
    pause : in
        With ``port``: no further burst begins.
    """

    def __init__(
        self, platform, config: EngineConfig, port=None, *, initial=False, name="splatline"
    ):
        self.platform, self.config, self.module = platform, config, name
        self.data_bits = None if port is None else port.data_width
        bits = register_map(config).address_bits
        word_bytes, beat_bytes = codeword_stream_bytes(config), raster_stream_bytes(config)
        # LiteX names a signal after the variables of its way, so all are made here.
        self.bus = AXILiteInterface(data_width=32, address_width=32)
        self.bus_bytes = 1 << bits
        self.codewords = stream.Endpoint([("data", 8 * word_bytes)])
        self.irq = Signal()

        # # #

        wires = _lite(self.bus, bits) | _stream_in("s_axis_codewords", self.codewords)
        if initial:
            self.initial = stream.Endpoint([("data", 8 * beat_bytes)])
            wires |= _stream_in("s_axis_initial", self.initial)
        else:
            wires |= _nothing_in("s_axis_initial", beat_bytes)
        if port is None:
            self.raster = stream.Endpoint([("data", 8 * beat_bytes)])
            wires |= _stream_out("m_axis_raster", self.raster)
        else:
            self.buffer_0 = Signal(32)
            self.buffer_1 = Signal(32)
            self.stride = Signal(16)
            self.background = Signal(24)
            self.swap_valid = Signal()
            self.swap_index = Signal()
            self.swapped = Signal()
            self.pause = Signal()
            self.writer_error = CSRStatus(1, description="a write to SDRAM failed, since reset")
            memory = LiteDRAMAXIPort(data_width=self.data_bits, address_width=32, id_width=1)
            self.to_memory = LiteDRAMAXI2Native(memory, port)
            failed, address_valid = Signal(), Signal()
            self.comb += memory.aw.valid.eq(address_valid & ~self.pause)
            self.sync += If(failed, self.writer_error.status.eq(1))
            wires |= {
                **_write_master(memory),
                "o_m_axi_awvalid": address_valid,
                "i_m_axi_awready": memory.aw.ready & ~self.pause,
                "o_writer_error": failed,
                **{f"i_{name}": getattr(self, name) for name in FRAME_BUFFER_IN},
                **{f"o_{name}": getattr(self, name) for name in FRAME_BUFFER_OUT},
            }
        self.specials += Instance(
            name, i_aclk=ClockSignal(), i_aresetn=~ResetSignal(), o_irq=self.irq, **wires
        )

    def do_finalize(self):
        """Write the Verilog, and add it to the platform.

        Raises
        ------
        ValueError
            If another engine has this name.
        """
        if self.data_bits is None:
            text, _ = generate_axi(self.config, self.module)
        else:
            text, _ = generate_framebuffer(self.config, self.module, data_bits=self.data_bits)
        # LiteX's builder sets the folder before it finalises the SoC.
        folder = Path(self.platform.output_dir or "build").resolve() / "gateware"
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{self.module}.v"
        others = [source for source, *_ in self.platform.sources]
        if str(file) in others and file.read_text() != text:
            raise ValueError(f"two engines that differ have the name {self.module!r}")
        file.write_text(text)
        self.platform.add_source(str(file))


def _stream_in(bus: str, words: stream.Endpoint) -> dict:
    """Return the connections of a stream into the engine; all bytes of a word are there."""
    return {
        f"i_{bus}_tdata": words.data,
        f"i_{bus}_tkeep": (1 << len(words.data) // 8) - 1,
        f"i_{bus}_tlast": words.last,
        f"i_{bus}_tvalid": words.valid,
        f"o_{bus}_tready": words.ready,
    }


def _nothing_in(bus: str, size: int) -> dict:
    """Return the connections of a stream that never sends."""
    return {
        f"i_{bus}_tdata": Constant(0, 8 * size),
        f"i_{bus}_tkeep": (1 << size) - 1,
        f"i_{bus}_tlast": 0,
        f"i_{bus}_tvalid": 0,
    }


def _stream_out(bus: str, words: stream.Endpoint) -> dict:
    """Return the connections of a stream out of the engine."""
    return {
        f"o_{bus}_tdata": words.data,
        f"o_{bus}_tlast": words.last,
        f"o_{bus}_tvalid": words.valid,
        f"i_{bus}_tready": words.ready,
    }


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
