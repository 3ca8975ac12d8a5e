"""Cutting a beat of two words into the two, for a window that is loaded word by word."""

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import LoadLayout

__all__ = ["Halver"]


class Halver(wiring.Component):
    """Offers the two words of a beat after each other, but none that is all background.

    A beat that is all background gives its right word. Which words a beat has is known with it: the
    way from its depths to the banks would be long.

    **Latency**: 1 cycle. **Throughput**: a word a cycle.

    Members
    -------
    i : In(stream of LoadLayout)
        Beats of two words; ``word`` is the left one's number. No ends.
    o : Out(stream of LoadLayout)
        Their words, each with the pixels of its beat.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(LoadLayout(config))),
                "o": Out(stream.Signature(LoadLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        pixels = self.config.pixels_per_word
        depths = self.i.payload.pixels.depth
        left_empty, right_empty = (
            Cat(depth.all() for depth in depths[half * pixels : (half + 1) * pixels]).all()
            for half in range(2)
        )
        valid = Signal()
        beat = Signal(LoadLayout(self.config), reset_less=True)
        right = Signal(reset_less=True)  # it is the right word's turn
        last = Signal(reset_less=True)  # that is the beat's last
        m.d.comb += [
            self.i.ready.eq(~valid | (self.o.ready & last)),
            self.o.valid.eq(valid),
            self.o.payload.eq(beat),
            self.o.payload.word[0].eq(right),
        ]
        with m.If(self.i.ready):
            m.d.sync += [
                valid.eq(self.i.valid),
                beat.eq(self.i.payload),
                right.eq(left_empty),
                last.eq(left_empty | right_empty),
            ]
        with m.Elif(self.o.ready):
            m.d.sync += [right.eq(1), last.eq(1)]
        return m
