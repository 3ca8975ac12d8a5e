"""The sliding window of banks: what elements pass through on their way to the raster."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from .bank import Bank
from .bank_arbiter import BankArbiter
from .bank_walker import BankWalker
from .emitter import Emitter
from .format import ROWS, EngineConfig
from .halver import Halver
from .layouts import FootprintLayout, PlaneLayout, RasterLayout, WordLayout
from .loader import Loader
from .paint import Paint, cut
from .planar_bank import PlanarBank
from .scatter import Scatter

__all__ = ["Window"]


class Window(wiring.Component):
    """Draws footprints into sixteen lines that slide down the image.

    Four stages: *deal* (a word to each bank, see :class:`Scatter`), *request* (an address a bank,
    see :class:`BankArbiter`), *merge* (the banks write back; a flushed word stands on its bank's
    output) and *emit* (the word waits on ``raster``). A word that ``raster`` does not take stops
    all four.

    Colours cut into planes (:class:`PlanarBank`) add two stages between merge and emit, in which
    the further planes are read and then written.

    After reset the banks are cleared, which takes as many cycles as a bank has words.

    **Latency**: 5 cycles from a retired line to its first beat, 7 with further planes.
    **Throughput**: 1 to 3 cycles an element, with sixteen banks 1 or 2, or always 1 (see
    :class:`Scatter`), one more where it follows into the word that its predecessor wrote last; a
    beat of ``raster``, or a word in two cycles of the initial raster, while its banks are free.
    With further planes each word with a pixel that passes the depth test takes its bank for a
    second cycle, so that an element takes 6 at most and one more; so does a word of the initial
    raster, and of ``raster`` unless it is background.

    Members
    -------
    i : In(stream of FootprintLayout)
        Elements in the order of their lines, all of which are in the window: see ``running``. An
        ``end`` token is taken once all before it is drawn, nothing more comes of its frame's
        initial raster, and the frame before is out; then the next frame may follow.
    moves : Out(1)
        The element that is offered on ``i`` moves on to where it is drawn, and its colour with it.
    shade : In
        Colour of the element that last moved on.
    oldest : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded, of the frame that is drawn.
    running : Out(1)
        Low: the window stands still. An element may be offered after a cycle in which it does not
        and has all lines of the element.
    initial : In(stream of RasterLayout)
        Initial raster; read if ``load`` is set.
    raster : Out(stream of RasterLayout)
        The words in which something was drawn, then an ``end`` beat.
    last_column, last_line : In
        Size of the image less 1; steady until ``finished``, as is ``load``.
    load : In(1)
        The frame starts from the initial raster.
    active : In(1)
        A frame is open: from its first code word until its ``end`` token is taken.
    closing : Out(1)
        A frame whose ``end`` token was taken is not out.
    finished : Out(1)
        High for one cycle: the frame's end beat goes into the emit stage.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(FootprintLayout(config))),
                "moves": Out(1),
                "shade": In(3 * (config.channel_bits + config.dither_bits)),
                "oldest": Out(signed(config.line_bits + 2)),
                "running": Out(1),
                "initial": In(stream.Signature(RasterLayout(config))),
                "raster": Out(stream.Signature(RasterLayout(config))),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
                "load": In(1),
                "active": In(1),
                "closing": Out(1),
                "finished": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        footprint = self.i.payload

        m.submodules.walker = walker = BankWalker(config)
        m.submodules.loader = loader = Loader(config)
        m.submodules.scatter = scatter = Scatter(config)
        m.submodules.arbiter = arbiter = BankArbiter(config)
        m.submodules.paint = paint = Paint(config)
        m.submodules.emitter = emitter = Emitter(config)
        whole = config.colour_planes == 1  # words are drawn in one access
        banks = [Bank(config) if whole else PlanarBank(config) for _ in range(config.banks)]
        for index, bank in enumerate(banks):
            m.submodules[f"bank_{index}"] = bank
        running = emitter.running

        close = Signal()  # the end token is taken
        last_word = self.last_column[config.pixel_bits :]
        m.d.comb += [
            walker.last_word.eq(last_word),
            walker.jump.eq(loader.finished),
            walker.restart.eq(self.finished),
            walker.idle.eq(~scatter.i.valid & ~scatter.o.valid),
            loader.enable.eq(self.load),
            loader.active.eq(self.active),
            loader.last_line.eq(self.last_line),
            loader.last_word.eq(last_word),
            loader.oldest.eq(walker.front),
            loader.restart.eq(close),
            walker.close.eq(close),
            self.oldest.eq(loader.front),
            self.running.eq(running),
            self.closing.eq(walker.closing),
        ]
        if config.raster_words == 1:
            connect(m, flipped(self.initial), loader.i)
            m.d.comb += walker.limit.eq(loader.limit)
            loads = loader.o
        else:
            m.submodules.halver = halver = Halver(config)
            beat = self.initial.payload
            m.d.comb += [
                loader.i.valid.eq(self.initial.valid),
                loader.i.payload.pixels.eq(beat.pixels),
                loader.i.payload.word.eq(Cat(0, beat.word)),
                loader.i.payload.line.eq(beat.line),
                loader.i.payload.end.eq(beat.end),
                self.initial.ready.eq(loader.i.ready),
                loader.held.eq(halver.o.valid),
            ]
            # A beat is taken while the last word before it is written, which is marked a cycle
            # after.
            m.d.sync += walker.limit.eq(loader.limit)
            connect(m, loader.o, halver.i)
            loads = halver.o

        # Deal: elements, as long as there are no end tokens, for which nothing may be left to draw.
        deal = scatter.o.payload
        top = Signal.like(footprint.top, init=-ROWS)  # of what is dealt, or of what comes next
        retired = Signal.like(top)  # what was drawn above it is known to have been written
        m.d.comb += [
            scatter.i.valid.eq(self.i.valid & ~footprint.end),
            scatter.i.payload.eq(footprint),
            scatter.enable.eq(running),
            self.moves.eq(scatter.moves),
            close.eq(
                self.i.valid & footprint.end & ~scatter.o.valid & loader.finished & ~walker.closing
            ),
            self.i.ready.eq(Mux(footprint.end, close, scatter.i.ready)),
            walker.top.eq(retired),
        ]
        m.d.sync += retired.eq(top)
        with m.If(~scatter.o.valid | scatter.o.ready):
            m.d.sync += top.eq(footprint.top)
        with m.If(close):
            m.d.sync += [top.eq(top.init), retired.eq(top.init)]  # of the next frame

        # Request: who may use the banks.
        connect(m, scatter.o, arbiter.draw)
        connect(m, loads, arbiter.load)
        connect(m, walker.flush, arbiter.flush)
        m.d.comb += [
            arbiter.running.eq(running),
            arbiter.stale.eq(scatter.stale),
            arbiter.may_flush.eq(emitter.ready),
            arbiter.early.eq(walker.early),
            arbiter.ahead.eq(top - walker.front),
            scatter.taken.eq(arbiter.taken),
            walker.wipe.eq(arbiter.wiping),
            walker.reaching.eq(arbiter.drawing & running),
            walker.reach.eq(deal.reach),
        ]

        if config.banks == 8:
            # Splats of three lines leave the banks of the line ten below ``top`` free, of all lines
            # that are a multiple of four apart: what is nearer goes first, so that it comes to
            # that. With sixteen no line of the window below them is in their way for long.
            distance = Signal(3)
            m.d.comb += distance.eq(loads.payload.line[:3] - top[:3])
            m.d.comb += arbiter.behind.eq((distance < 2) | (distance > 5))

        # Merge: what the banks draw, and the way out of what they give up.
        connect(m, emitter.raster, flipped(self.raster))
        m.d.comb += [
            paint.enable.eq(running),
            paint.z.eq(deal.z),
            paint.shade.eq(self.shade),
            emitter.flush.eq(walker.flush.valid & walker.flush.ready),
            emitter.request.eq(walker.flush.payload),
            emitter.last_column.eq(self.last_column),
            emitter.end.eq(walker.over),
            self.finished.eq(emitter.finished),
        ]
        loaded = self._loaded(m, loads.payload, arbiter.further)
        for index, bank in enumerate(banks):
            m.d.comb += [
                bank.enable.eq(running),
                bank.request.eq(arbiter.requests[index]),
                bank.new.eq(paint.new[index % len(paint.new)]),
                bank.loaded.eq(loaded),
                emitter.words[index].eq(bank.leaving if whole else bank.old),
                walker.drawn[index].eq(bank.drawn),
                walker.addresses[index].eq(bank.drawn_address),
            ]
            if not whole:
                m.d.comb += arbiter.busy[index].eq(bank.busy)
        return m

    def _loaded(self, m, load, further):
        """Return the word of the initial raster as the banks take it, or its further planes."""
        config = self.config
        count = config.pixels_per_word
        word = Signal(WordLayout(config), name="loaded_word")
        right = load.word[0] if config.raster_words == 2 else 0
        for name in ("depth", "colour"):
            pixels = load.pixels[name]
            for pixel in range(count):
                m.d.comb += word[name][pixel].eq(
                    Mux(right, pixels[pixel + count * (config.raster_words - 1)], pixels[pixel])
                )
        if config.colour_planes == 1:
            return word
        parts = Signal(data.ArrayLayout(PlaneLayout(config), 2), name="loaded_parts")
        for pixel in range(count):
            m.d.comb += cut(config, parts, pixel, word.depth[pixel], word.colour[pixel])
        return Mux(further, parts[1], parts[0])
