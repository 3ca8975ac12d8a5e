"""Loading the initial raster: the previous engine's picture, or none."""

from amaranth.hdl import Module, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import LoadLayout

__all__ = ["Loader"]


class Loader(wiring.Component):
    """Offers the initial raster's words as their lines enter the window.

    A word goes to memory like an element of its pixels with their own depths and colours: the
    window is background where nothing was loaded, so the depth test lets all but background pass.
    Words outside the image are dropped, and words of lines that have left or that lie above the
    line of the word before: once a line was waited for, those before it may be on their way out.

    **Latency**: 1 cycle. **Throughput**: one word in two cycles, the first of which tells whether
    its line is in the window; or one a cycle that is dropped.

    Members
    -------
    i : In(stream of LoadLayout)
        The initial raster. Taken during a frame alone, and only if ``enable`` is set.
    o : Out(stream of LoadLayout)
        Words to write; their lines are in the window.
    enable : In(1)
        The frame starts from an initial raster.
    active : In(1)
        A frame is being drawn.
    last_line : In(line_bits)
        Height of the image less 1.
    last_word : In(word_bits)
        Number of the last word of a line.
    oldest : In(signed(line_bits + 2))
        First line in the window.
    restart : In(1)
        The frame is complete: what comes is of the next one.
    moves : In(1)
        The window may move on by many lines in this cycle.
    finished : Out(1)
        No initial raster will come any more in this frame.
    loaded : Out(1)
        Nothing more will come for any line of the window as it was one cycle ago. Since then the
        window may have moved on by one line, but no further unless ``finished``; so nothing will
        come for its lines but the last. Low after a cycle in which it ``moves``, unless
        ``finished``.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(LoadLayout(config))),
                "o": Out(stream.Signature(LoadLayout(config))),
                "enable": In(1),
                "active": In(1),
                "last_line": In(config.line_bits),
                "last_word": In(config.word_bits),
                "oldest": In(signed(config.line_bits + 2)),
                "restart": In(1),
                "moves": In(1),
                "finished": Out(1),
                "loaded": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        beat = self.i.payload
        ended = Signal()
        waiting = Signal()
        drop = Signal()
        in_window = Signal()
        offered = Signal()
        beyond = Signal()  # one cycle ago a word waited whose line is yet to come
        ahead = Signal(signed(config.line_bits + 2))
        before = Signal(config.line_bits)  # line of the last word that went in
        m.d.comb += [
            waiting.eq(self.i.valid & self.enable & self.active & ~ended),
            ahead.eq(beat.line - self.oldest),
            # Less than the window's lines.
            in_window.eq(ahead[-1] | ~ahead[config.slot_bits : -1].any()),
            drop.eq(
                beat.end
                | (ahead < 0)
                | (beat.line < before)
                | (beat.line > self.last_line)
                | (beat.word > self.last_word)
            ),
            self.o.valid.eq(offered),
            self.o.payload.eq(beat),
            self.i.ready.eq((waiting & drop) | (self.o.valid & self.o.ready)),
            self.finished.eq(~self.enable | ended),
            self.loaded.eq(self.finished | beyond),
        ]
        m.d.sync += [
            offered.eq(waiting & ~drop & in_window & ~(self.o.valid & self.o.ready)),
            beyond.eq(waiting & ~drop & ~in_window & ~self.moves),
        ]
        with m.If(waiting & beat.end):
            m.d.sync += ended.eq(1)
        with m.If(self.o.valid & self.o.ready):
            m.d.sync += before.eq(beat.line)
        with m.If(self.restart):
            m.d.sync += [ended.eq(0), before.eq(0)]
        return m
