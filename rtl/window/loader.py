"""Loading the initial raster: the previous engine's picture, or none."""

from amaranth.hdl import Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import LoadLayout

__all__ = ["Loader"]


class Loader(wiring.Component):
    """Offers the initial raster's words as their lines enter the window.

    A word is copied into memory while its line is still background, beside whatever is drawn and
    leaves elsewhere: an element waits until its lines have come, and a line until it has come
    before it leaves. Beats outside the image are dropped, and words of lines above that of the word
    before: once a line was waited for, those before it may be on their way out. A beat of two words
    is written as a whole, even if the right one lies outside, where nothing ever leaves.

    **Latency**: 1 cycle. **Throughput**: one beat in two cycles, the first of which tells whether
    its line is in the window; or one a cycle that is dropped.

    Members
    -------
    i : In(stream of LoadLayout)
        The initial raster. Taken during a frame alone, and only if ``enable`` is set.
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
        The frame is complete: what comes is of the next one.
    finished : Out(1)
        No initial raster will come any more in this frame.
    limit : Out(signed(line_bits + 2))
        The lines above this one have received all of the initial raster that is meant for them.
        Never falls during a frame, but among lines above the image. Means nothing once
        ``finished``.
    front : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded, or ``oldest`` once ``finished``:
        ``window_lines`` above ``limit``, or one less where they are more than eight, as nothing is
        drawn into the last of them.
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
        # Nothing is drawn into the window's last line, whose place was left just now; but a window
        # of eight lines has no other for the last row of a block.
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
        limit = Signal.like(self.limit)  # so many lines below: an addition less on a long way
        m.d.comb += [
            waiting.eq(self.i.valid & self.enable & self.active & ~ended),
            ahead.eq(beat.line - self.oldest),
            # Not before the window: a line leaves when it lies above ``limit``.
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
            # One that waits below the window says that all lines of the window have come.
            m.d.sync += [
                loaded.eq(Mux(in_window, beat.line - lines, self.oldest)),
                limit.eq(Mux(in_window, beat.line, self.oldest + lines)),
            ]
        with m.If(self.restart):
            m.d.sync += [ended.eq(0), loaded.eq(loaded.init), limit.eq(0)]
        return m
