"""The sliding window: eight banks, and who may use them in a cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from .bank import Bank
from .bank_layout import BANKS
from .bank_walker import BankWalker
from .emitter import Emitter
from .format import ROWS, EngineConfig
from .halver import Halver
from .layouts import FlushLayout, FootprintLayout, PlaceLayout, RasterLayout
from .loader import Loader
from .paint import Paint
from .planar_bank import PlanarBank
from .scatter import Scatter

__all__ = ["Window"]


class Window(wiring.Component):
    """Draws footprints into sixteen lines that slide down the image.

    Four stages: *deal* (a word to each bank, see :class:`Scatter`), *request* (an address a bank),
    *merge* (the banks write back; a flushed word stands on its bank's output) and *emit* (the word
    waits on ``raster``). In the request stage the initial raster goes first, then the element, and
    the flush takes what banks are left; unless six lines or more wait for it, then it goes before
    the element. A word that ``raster`` does not take stops all four.

    Colours cut into planes (:class:`PlanarBank`) add two stages between merge and emit, in which
    the further planes are read and then written.

    After reset the banks are cleared, which takes as many cycles as a bank has words.

    **Latency**: 7 cycles from a retired line to its first beat, 9 with further planes.
    **Throughput**: 1 to 3 cycles an element (see :class:`Scatter`), one more where it follows into
    the word that its predecessor wrote last; a word a cycle of the initial raster, and a beat of
    ``raster`` while its banks are free. With further planes each word with a pixel that passes the
    depth test takes its bank for a second cycle, so that an element takes 6 at most and one more;
    two words in four cycles of the initial raster, and of ``raster`` unless they are background.

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
        First line in the window, of the frame that is drawn.
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
        m.submodules.paint = paint = Paint(config)
        m.submodules.emitter = emitter = Emitter(config)
        banks = [
            Bank(config) if config.colour_planes == 1 else PlanarBank(config) for _ in range(BANKS)
        ]
        for index, bank in enumerate(banks):
            m.submodules[f"bank_{index}"] = bank
        running = emitter.running

        sweeping = Signal(init=1)
        sweep = Signal(len(banks[0].request.address))
        with m.If(sweeping):
            m.d.sync += [sweep.eq(sweep + 1), sweeping.eq(~sweep.all())]
        swept = Signal(2, init=3)  # one and two cycles before: words are still to be written
        m.d.sync += swept.eq(Cat(sweeping, swept))

        close = Signal()  # the end token is taken
        last_word = self.last_column[2:]
        m.d.comb += [
            walker.last_word.eq(last_word),
            walker.loaded.eq(loader.loaded),
            walker.jump.eq(loader.finished),
            walker.wipe.eq(swept[0]),
            walker.restart.eq(self.finished),
            loader.enable.eq(self.load),
            loader.active.eq(self.active),
            loader.last_line.eq(self.last_line),
            loader.last_word.eq(last_word),
            loader.oldest.eq(walker.front),
            loader.restart.eq(close),
            # Of a frame that was closed, lines without words are passed over many at a time.
            loader.moves.eq(self.finished | walker.closing),
            walker.close.eq(close),
            self.oldest.eq(walker.front),
            self.running.eq(running),
            self.closing.eq(walker.closing),
        ]
        if config.raster_words == 1:
            connect(m, flipped(self.initial), loader.i)
        else:
            m.submodules.halver = halver = Halver(config)
            connect(m, flipped(self.initial), halver.i)
            connect(m, halver.o, loader.i)

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

        # Request: the initial raster, else the element, and a flush in a bank that neither wants.
        drawing = Signal()
        loading = Signal()
        flushing = Signal()
        held = Signal(BANKS)
        loaded = Signal(2)  # one and two cycles before: that word is still to be written
        last = Signal(PlaceLayout(config), reset_less=True)  # which one
        left = Signal(2)  # the same of words that are flushed
        last_left = Signal(config.slot_bits, reset_less=True)  # of which line
        m.d.comb += [
            drawing.eq(
                scatter.o.valid & ~Cat(swept, loaded).any() & ~loader.o.valid & loader.loaded
            ),
            scatter.o.ready.eq(drawing & running & ~(deal.want & ~scatter.taken).any()),
        ]
        leaving = walker.flush.payload
        service = Signal(FlushLayout(config))
        service_address = Signal.like(sweep)
        m.d.comb += [
            service.eq(leaving),
            service_address.eq(Cat(service.pair, service.line[2:4])),
        ]
        word, line = loader.o.payload.word, loader.o.payload.line
        with m.If(loader.o.valid):
            upper = word[0] ^ line[2]
            m.d.comb += [
                service.pair.eq(word[1:]),
                service.line.eq(line),
                service.halves.eq(Cat(~upper, upper)),
            ]
        with m.If(sweeping):
            m.d.comb += service_address.eq(sweep)
        # Where six complete lines wait, flushing goes before the element in the bank that it needs,
        # or keeps both of the oldest line, whose marks it waits for. Six, as splats of a few pixels
        # then lie in other banks than the oldest line; four or eight lines apart they are the same.
        urgent = Signal()
        waiting = Signal()  # so many lines wait; known a cycle late
        ahead = Signal.like(top)
        m.d.comb += [ahead.eq(top - walker.front), urgent.eq(waiting & emitter.ready)]
        m.d.sync += waiting.eq(~ahead[-1] & ahead[1:3].all())
        free = Signal(BANKS)  # for what is to be served
        for index, bank in enumerate(banks):
            share = deal.shares[index]
            mine = Signal(name=f"service_{index}")
            wanted = Signal(name=f"wanted_{index}")
            has_line, half = service.line[:2] == index % 4, service.halves[index // 4]
            # What leaves, or is loaded, is never a word that is being drawn into.
            busy = bank.busy if config.colour_planes > 1 else 0
            m.d.comb += [
                held[index].eq(
                    urgent
                    & (leaving.line[:2] == index % 4)
                    & (leaving.halves[index // 4] | ~walker.flush.valid)
                ),
                wanted.eq(drawing & deal.want[index] & ~held[index]),
                scatter.taken[index].eq(wanted & ~scatter.stale[index] & ~busy & running),
                mine.eq(has_line & half & ~wanted),
                free[index].eq(has_line & ~wanted & ~busy),
                bank.enable.eq(running),
                bank.request.address.eq(Mux(wanted, share.address, service_address)),
                bank.request.mask.eq(share.mask),
                bank.request.whole.eq(loader.o.valid),
                bank.request.draw.eq(scatter.taken[index] | (loading & mine)),
                bank.request.clear.eq((flushing & mine) | sweeping),
            ]
        served, again = Signal(), Signal()
        m.d.comb += [
            served.eq((Cat(free[:4].any(), free[4:].any()) | ~service.halves).all()),
            # Neither the word that was loaded just now nor one whose place was given up just now.
            again.eq(
                (loaded[1] & (Cat(last.word, last.line) == Cat(word, line)))
                | (left.any() & (last_left == line[: len(last_left)]))
            ),
            loader.o.ready.eq(
                running & ~sweeping & ~swept.any() & ~again & paint.may_load & served
            ),
            walker.flush.ready.eq(running & ~sweeping & ~loader.o.valid & emitter.ready & served),
            loading.eq(loader.o.valid & loader.o.ready),
            flushing.eq(walker.flush.valid & walker.flush.ready),
            walker.reaching.eq(drawing & running),
            walker.reach.eq(deal.reach),
        ]

        with m.If(running):
            m.d.sync += [loaded.eq(Cat(loading, loaded)), left.eq(Cat(flushing, left))]
        with m.If(loading):
            m.d.sync += [last.word.eq(word), last.line.eq(line)]
        with m.If(flushing):
            m.d.sync += last_left.eq(service.line)

        # Merge: what the banks draw, and the way out of what they give up.
        connect(m, emitter.raster, flipped(self.raster))
        m.d.comb += [
            paint.enable.eq(running),
            paint.z.eq(deal.z),
            paint.shade.eq(self.shade),
            paint.load.eq(loader.o.valid << (word[0] if config.raster_words == 2 else 0)),
            paint.loaded.eq(loader.o.payload.pixels),
            paint.drawing.eq(drawing),
            emitter.flush.eq(flushing),
            emitter.request.eq(leaving),
            emitter.last_column.eq(self.last_column),
            emitter.end.eq(walker.over),
            self.finished.eq(emitter.finished),
        ]
        for index, bank in enumerate(banks):
            m.d.comb += [
                bank.new.eq(paint.new[index % len(paint.new)]),
                emitter.words[index].eq(bank.old),
                walker.drawn[index].eq(bank.drawn),
                walker.addresses[index].eq(bank.drawn_address),
                scatter.drawn[index].eq(bank.drawn),
                scatter.addresses[index].eq(bank.drawn_address),
            ]
        return m
