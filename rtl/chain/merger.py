"""The merger: joins two rasters, and keeps the nearer of two pixels."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import RasterLayout
from splatline.rtl.lib.fifo import Fifo

__all__ = ["Merger"]

ROOM = 2
"""Beats in a merger's output fifo: the fewest with a throughput of one beat a cycle."""


class Merger(wiring.Component):
    """Joins two rasters into one, as if ``own`` were drawn over ``before``.

    Both rasters are sorted. The beat of the lower position goes first. Two beats of the same
    position become one, with the nearer of the two pixels at each column. Of two equal depths the
    pixel of ``before`` stays, as with the depth test Z < stored. The end beat counts as the highest
    position, so the two ends become one, and frames never mix.

    Stall: the merger waits until both sides offer a beat, because the next beat of one side could
    precede that of the other. A side without beats for many lines stalls the other side until its
    next beat or its end, so both need a fifo before them. There is no deadlock: the merger waits
    for one side only while the other side offers a beat, and never for a beat behind one that it
    has not taken.

    No combinational path leads from one port's ``ready`` to another's, or from a beat to ``o``:
    each beat goes through a fifo.

    **Latency**: 2 cycles. **Throughput**: a beat a cycle.

    Parameters
    ----------
    config
        The configuration of the engines that draw the rasters.

    Members
    -------
    before : In(stream of RasterLayout)
        The raster that is drawn first.
    own : In(stream of RasterLayout)
        The raster that is drawn over it.
    o : Out(stream of RasterLayout)
        The joined raster.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        beats = stream.Signature(RasterLayout(config))
        super().__init__({"before": In(beats), "own": In(beats), "o": Out(beats)})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.way_out = way_out = Fifo(self.config, ROOM)
        before, own, joined = self.before.payload, self.own.payload, way_out.i.payload

        first = Signal()  # ``before`` has the lower position
        second = Signal()  # ``own`` has it; neither: the positions are equal
        place_before, place_own = Cat(before.word, before.line), Cat(own.word, own.line)
        m.d.comb += [
            first.eq(~before.end & (own.end | (place_before < place_own))),
            second.eq(~own.end & (before.end | (place_own < place_before))),
            way_out.i.valid.eq(self.before.valid & self.own.valid),
            self.before.ready.eq(way_out.i.ready & self.own.valid & ~second),
            self.own.ready.eq(way_out.i.ready & self.before.valid & ~first),
            joined.word.eq(Mux(second, own.word, before.word)),
            joined.line.eq(Mux(second, own.line, before.line)),
            joined.end.eq(before.end & own.end),
        ]
        nearer = Signal(self.config.raster_pixels)  # pixels of ``before`` that stay
        for pixel, depth in enumerate(before.pixels.depth):
            stays = first | (nearer[pixel] & ~second)
            m.d.comb += nearer[pixel].eq(depth <= own.pixels.depth[pixel])
            for kind in ("depth", "colour"):
                m.d.comb += joined.pixels[kind][pixel].eq(
                    Mux(stays, before.pixels[kind][pixel], own.pixels[kind][pixel])
                )
        connect(m, way_out.o, flipped(self.o))
        return m
