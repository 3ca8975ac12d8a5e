"""Cutting a beat of two words into the two, for a window that is loaded word by word."""

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import LoadLayout, RasterLayout

__all__ = ["Halver"]


class Halver(wiring.Component):
    """Offers the two words of a beat after each other, but none that is all background.

    An end beat is passed on; a beat that is all background gives its right word.

    **Latency**: none. **Throughput**: a word a cycle.

    Members
    -------
    i : In(stream of RasterLayout)
        Beats of two words; ``raster_words`` is 2.
    o : Out(stream of LoadLayout)
        Their words, each with the pixels of its beat.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(RasterLayout(config))),
                "o": Out(stream.Signature(LoadLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        pixels = self.config.pixels_per_word
        beat, word = self.i.payload, self.o.payload
        left_done = Signal()
        right = Signal()
        empty = [
            Cat(depth.all() for depth in beat.pixels.depth[half * pixels : (half + 1) * pixels])
            for half in range(2)
        ]
        last = Signal()
        m.d.comb += [
            right.eq(left_done | empty[0].all()),
            last.eq(right | empty[1].all() | beat.end),
            self.o.valid.eq(self.i.valid),
            self.i.ready.eq(self.o.ready & last),
            word.word.eq(Cat(right, beat.word)),
            word.line.eq(beat.line),
            word.end.eq(beat.end),
            word.pixels.eq(beat.pixels),
        ]
        with m.If(self.o.valid & self.o.ready):
            m.d.sync += left_done.eq(~last)
        return m
