"""The ring of sixteen lines: which are drawn into, and which leave the window next."""

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig

__all__ = ["PlaceLayout", "Ring"]


class PlaceLayout(data.StructLayout):
    """A word's place in the image."""

    def __init__(self, config: EngineConfig):
        super().__init__({"word": config.word_bits, "line": config.line_bits})


class Ring(wiring.Component):
    """Walks over the lines that no later element touches and asks for each to be flushed.

    Line n of the image stands in place n mod 16 of the window. ``oldest`` is the first line that
    has not left: lines ``oldest .. oldest + 15`` are in the window, those above ``top`` are on
    their way out. A line that nothing was written into leaves in one cycle, and all at once if
    none was written.

    **Latency**: 1 cycle. **Throughput**: one word a cycle.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete. Never falls during a frame.
    loaded : In(1)
        Line ``oldest`` has received all of the initial raster that is meant for it.
    jump : In(1)
        No initial raster will come for any line: lines may leave many at a time.
    touch : In(16)
        Places of the window that an element is written into in this cycle.
    load : In(1)
        A word of the initial raster is written into the window; no line is flushed meanwhile.
    load_place : In(4)
        The place of that word's line.
    last_word : In(word_bits)
        Number of the last word of a line.
    restart : In(1)
        The frame is over: go back to line 0.
    oldest : Out(line_bits + 1)
        First line in the window.
    clean : Out(1)
        No line of the window is written.
    flush : Out(stream of PlaceLayout)
        Words to read and clear.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "top": In(signed(config.line_bits + 2)),
                "loaded": In(1),
                "jump": In(1),
                "touch": In(config.window_lines),
                "load": In(1),
                "load_place": In(range(config.window_lines)),
                "last_word": In(config.word_bits),
                "restart": In(1),
                "oldest": Out(config.line_bits + 1),
                "clean": Out(1),
                "flush": Out(stream.Signature(PlaceLayout(config))),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        written = Signal(config.window_lines)
        word = Signal(config.word_bits)
        leaving = Signal()
        left = Signal()  # the oldest line's last word is flushed in this cycle
        slot = self.oldest[: config.window_lines.bit_length() - 1]

        m.d.comb += [
            leaving.eq((self.oldest < self.top) & self.loaded),
            left.eq(self.flush.valid & self.flush.ready & (word == self.last_word)),
            self.clean.eq(~written.any()),
            self.flush.valid.eq(leaving & written.bit_select(slot, 1)),
            self.flush.payload.word.eq(word),
            self.flush.payload.line.eq(self.oldest),
        ]
        # Loading marks a place and flushing clears one, never in the same cycle.
        place = Signal.like(self.load_place)
        m.d.comb += place.eq(Mux(self.load, self.load_place, slot))
        for number in range(config.window_lines):
            here = (place == number) & (self.load | left)
            m.d.sync += written[number].eq(
                Mux(here, self.load, written[number] | self.touch[number])
            )

        with m.If(self.flush.valid & self.flush.ready):
            m.d.sync += word.eq(Mux(left, 0, word + 1))
        with m.If(leaving & self.jump & self.clean):
            m.d.sync += self.oldest.eq(self.top)
        with m.Elif(leaving & (left | ~self.flush.valid)):
            m.d.sync += self.oldest.eq(self.oldest + 1)
        with m.If(self.restart):
            m.d.sync += self.oldest.eq(0)
        return m
