"""A short queue of beats between two that do not always keep the same pace."""

from amaranth.hdl import Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import RasterLayout

__all__ = ["Fifo"]

SHORT = 16
"""Beats of a memory whose words come out of registers; that of a longer one is a block RAM, which
is so slow that what compares the beats wants a register before it."""


class Fifo(wiring.Component):
    """Holds beats until they are taken, in order.

    No path leads through it: what it offers stands in a register, and whether it takes hangs on how
    full it is alone. So any number of them in a row are as fast as one.

    **Latency**: 2 cycles, 3 of more than 16 beats. **Throughput**: a beat a cycle.

    Parameters
    ----------
    config
        The engine's configuration.
    depth
        Beats in its memory, at least 2 (with 1, a beat passes in every other cycle); one more
        stands on the way out. With ``paper`` 32 take three block RAMs, and so do 256.

    Members
    -------
    i : In(stream of RasterLayout)
        Beats that come.
    o : Out(stream of RasterLayout)
        The same beats.
    level : Out(range(depth + 2))
        How many it holds, but for the one on the way out that a long queue has.
    """

    def __init__(self, config: EngineConfig, depth: int):
        self.config = config
        self.depth = depth
        beats = stream.Signature(RasterLayout(config))
        super().__init__({"i": In(beats), "o": Out(beats), "level": Out(range(depth + 2))})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        width = RasterLayout(self.config).size
        m.submodules.fifo = fifo = SyncFIFOBuffered(width=width, depth=self.depth + 1)
        m.d.comb += [
            fifo.w_data.eq(self.i.payload),
            fifo.w_en.eq(self.i.valid),
            self.i.ready.eq(fifo.w_rdy),
            self.level.eq(fifo.level),
        ]
        if self.depth <= SHORT:
            m.d.comb += [
                self.o.payload.eq(fifo.r_data),
                self.o.valid.eq(fifo.r_rdy),
                fifo.r_en.eq(self.o.ready),
            ]
            return m
        held = Signal(width, reset_less=True)
        valid = Signal()
        takes = Signal()
        m.d.comb += [
            takes.eq(~valid | self.o.ready),
            self.o.payload.eq(held),
            self.o.valid.eq(valid),
            fifo.r_en.eq(takes),
        ]
        with m.If(takes):
            m.d.sync += [valid.eq(fifo.r_rdy), held.eq(fifo.r_data)]
        return m
