"""The frame buffer top: an engine on AXI whose pictures go to memory."""

from __future__ import annotations

from amaranth.hdl import Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.rtl.bus.axi_top import AxiTop

from .frame_writer import FrameWriter

__all__ = ["FrameBufferTop"]


class FrameBufferTop(AxiTop):
    """The AXI top with a frame writer in the place of ``m_axis_raster``.

    Its ports are those of :class:`AxiTop`, without ``m_axis_raster_*``, and those of
    :class:`FrameWriter`: the bus as ``m_axi_*``, and the wires ``buffer_0``, ``buffer_1``,
    ``stride``, ``background``, ``swap_valid``, ``swap_index``, ``swapped`` and ``writer_error``.
    The size of the image is that of the registers LAST_COLUMN and LAST_LINE.

    The registers are those of the AXI top. FRAMES and IRQ_STATUS.FRAME_DONE count a frame when all
    of it is in memory. OUTPUT_STALLS counts cycles in which a beat waits for the frame writer. An
    aborted frame is swapped as any other: it is background alone from the line of the abort on.

    **Latency**: that of :class:`AxiTop` to the engine, and that of :class:`FrameWriter` behind it.
    **Throughput**: the smaller of both. The engine draws the next frame into its window while the
    picture before it waits for ``swapped``.

    Parameters
    ----------
    config
        The engine's configuration.
    data_bits, burst, outstanding
        Those of :class:`FrameWriter`.
    engine
        That of :class:`AxiTop`.
    """

    def __init__(
        self,
        config: EngineConfig = PAPER,
        data_bits: int = 64,
        *,
        burst: int = 64,
        outstanding: int = 8,
        engine: wiring.Component | None = None,
    ):
        self.writer = FrameWriter(config, data_bits, burst=burst, outstanding=outstanding)
        super().__init__(config, engine)

    def _picture_members(self):
        """Return the bus and the wires of the frame writer, by name."""
        members = self.writer.signature.members
        return {_outer_name(name): member for name, member in members.items() if name not in INNER}

    def _raster(self, m, values, aborting):
        """Connect the engine's beats to the frame writer; of an aborted frame only the end beat.

        Return whether a frame is done in this cycle, whether a beat is taken, and whether one
        waits.
        """
        m.submodules.writer = writer = self.writer
        raster = self.engine.raster
        offered = Signal()
        dropped = Signal()
        m.d.comb += [
            dropped.eq(aborting & ~raster.payload.end),
            offered.eq(raster.valid & ~dropped),
            writer.beats.payload.eq(raster.payload),
            writer.beats.valid.eq(offered),
            raster.ready.eq(writer.beats.ready | dropped),
            writer.last_column.eq(values.last_column_value),
            writer.last_line.eq(values.last_line_value),
        ]
        self._join(m, "m_axi", writer.m_axi)
        for name, member in writer.signature.members.items():
            if member.is_port and name not in INNER:
                port, inner = getattr(self, _outer_name(name)), getattr(writer, name)
                m.d.comb += inner.eq(port) if member.flow is In else port.eq(inner)
        taken = offered & writer.beats.ready & ~raster.payload.end
        return writer.frame_done, taken, offered & ~writer.beats.ready


INNER = ("beats", "last_column", "last_line", "frame_done")
"""Ports of the frame writer that are no ports of the top."""


def _outer_name(name: str) -> str:
    """Return the name that a port of the frame writer has in the top."""
    return "writer_error" if name == "error" else name
