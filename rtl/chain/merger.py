"""Joining two pictures on their way out: of every pixel the nearer one."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import RasterLayout
from splatline.rtl.lib.fifo import Fifo

__all__ = ["Merger"]

ROOM = 2
"""Beats that a merger's way out holds: as few as let one pass in every cycle."""


class Merger(wiring.Component):
    """Joins two rasters into the one that drawing one over the other gives.

    Both come sorted. The beat of the lower place goes on; two of the same place become one beat,
    which has the nearer of both at each pixel and the first of those of equal depth: what
    ``before`` drew stays, as if ``own`` had been drawn over it with the depth test Z < stored. A
    frame's end counts as the last of all places, so the two ends become one, and a frame never
    meets the next.

    It waits until both sides offer a beat: what comes next on one could always precede the other.
    A side that has nothing in many lines holds the other one up until its next beat or its end; so
    both want a queue before them. It cannot lock up: it waits for one side only while the other
    side's beat stands, and never for what comes behind a beat that it has not taken.

    No path leads from one port's ``ready`` to another's or from a beat to ``o``: each beat goes
    through a queue.

    **Latency**: 2 cycles. **Throughput**: a beat a cycle.

    Parameters
    ----------
    config
        The configuration of the engines that draw the rasters.

    Members
    -------
    before : In(stream of RasterLayout)
        What was drawn first.
    own : In(stream of RasterLayout)
        What was drawn over it.
    o : Out(stream of RasterLayout)
        Both together.
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

        first = Signal()  # the place of ``before`` lies before that of ``own``
        second = Signal()  # the other way round; neither: they are the same
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
