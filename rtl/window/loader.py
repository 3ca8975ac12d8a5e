"""The loader of the initial raster."""

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import LoadLayout

__all__ = ["Loader"]


class Loader(wiring.Component):
    """Offers the initial raster's words as their lines enter the window.

    A word is loaded while its line is still background, in parallel with drawing and flushing on
    other lines. Elements wait until their lines are loaded, and a line is not flushed before it is
    loaded.

    Beats outside the image are dropped. So are beats of a line above that of the beat before,
    because that line may be retired. A beat of two words is written whole, even if the right word
    lies outside the image, where no word is ever flushed.

    **Latency**: 1 cycle. **Throughput**: one beat in two cycles, the first of which compares its
    line with the window. A dropped beat takes one cycle.

    Members
    -------
    i : In(stream of LoadLayout)
        The initial raster. It is taken only during a frame, and only if ``enable`` is set.
    o : Out(stream of LoadLayout)
        Words to write, or beats of two; their lines are in the window.
    enable : In(1)
        The frame starts from an initial raster.
    active : In(1)
        A frame is being drawn.
    last_line : In(line_bits)
        Height of the image less 1.
    last_word : In(word_bits)
        Number of the last word of a line.
    oldest : In(signed(line_bits + 2))
        First line in the window, of the frame that is drawn.
    restart : In(1)
        The frame is complete: further beats are of the next one.
    finished : Out(1)
        The frame's initial raster has ended.
    limit : Out(signed(line_bits + 2))
        The lines above this one are loaded. It never falls during a frame, except among lines above
        the image. Means nothing once ``finished``.
    front : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded: ``window_lines`` above ``limit``, or one
        line less in a window of more than eight lines, whose last line is never drawn into. Once
        ``finished`` it is ``oldest``.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        line = signed(config.line_bits + 2)
        super().__init__(
            {
                "i": In(stream.Signature(LoadLayout(config))),
                "o": Out(stream.Signature(LoadLayout(config))),
                "enable": In(1),
                "active": In(1),
                "last_line": In(config.line_bits),
                "last_word": In(config.word_bits),
                "oldest": In(line),
                "restart": In(1),
                "finished": Out(1),
                "limit": Out(line),
                "front": Out(line),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        # The window's last line is not drawn into, because its slot may still be cleared. A window
        # of eight lines needs it for the last row of a block.
        lines = config.window_lines - (config.window_lines > BLOCK)
        beat = self.i.payload
        skip = config.raster_words - 1  # beats are compared
        ended = Signal()
        waiting = Signal()
        drop = Signal()
        in_window = Signal()
        offered = Signal()
        ahead = Signal(signed(config.line_bits + 2))
        loaded = Signal.like(self.front, init=-lines)
        limit = Signal.like(self.limit)  # a register of its own saves an adder on a long path
        m.d.comb += [
            waiting.eq(self.i.valid & self.enable & self.active & ~ended),
            ahead.eq(beat.line - self.oldest),
            # No line lies before the window, because only lines above ``limit`` leave.
            in_window.eq(~ahead[config.slot_bits :].any()),
            drop.eq(
                beat.end
                | (beat.line < self.limit)
                | (beat.line > self.last_line)
                | (beat.word[skip:] > self.last_word[skip:])
            ),
            self.o.valid.eq(offered),
            self.o.payload.eq(beat),
            self.i.ready.eq((waiting & drop) | (self.o.valid & self.o.ready)),
            self.finished.eq(~self.enable | ended),
            self.limit.eq(limit),
            self.front.eq(Mux(self.finished, self.oldest, loaded)),
        ]
        m.d.sync += offered.eq(waiting & ~drop & in_window & ~(self.o.valid & self.o.ready))
        with m.If(waiting & beat.end):
            m.d.sync += ended.eq(1)
        with m.If(waiting & ~drop):
            # If a beat waits below the window, all lines of the window are loaded.
            m.d.sync += [
                loaded.eq(Mux(in_window, beat.line - lines, self.oldest)),
                limit.eq(Mux(in_window, beat.line, self.oldest + lines)),
            ]
        with m.If(self.restart):
            m.d.sync += [ended.eq(0), loaded.eq(loaded.init), limit.eq(0)]
        return m
