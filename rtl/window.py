"""The sliding window: eight banks, and who may use them in a cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from .bank import Bank
from .bank_marks import column_bits
from .bank_walker import BankWalker
from .emitter import Emitter
from .format import EngineConfig
from .halver import Halver
from .layouts import FlushLayout, FootprintLayout, RasterLayout
from .loader import Loader
from .paint import Paint
from .planar_bank import PlanarBank
from .scatter import BANKS, Scatter

__all__ = ["Window"]


class Window(wiring.Component):
    """Draws footprints into sixteen lines that slide down the image.

    Three stages: *request* (an address a bank), *merge* (the banks write back; a flushed word
    stands on its bank's output) and *emit* (the word waits on ``raster``). In the request stage the
    initial raster goes first, then the element, and the flush takes what banks are left; unless six
    lines or more wait for it, then it goes before the element. A word that ``raster`` does not take
    stops all three.

    Colours cut into planes (:class:`PlanarBank`) add two stages between merge and emit, in which
    the further planes are read and then written.

    After reset the banks are cleared, which takes as many cycles as a bank has words.

    **Latency**: 5 cycles from a retired line to its first beat, 7 with further planes.
    **Throughput**: 1 to 3 cycles an element (see :class:`Scatter`), one more where it follows into
    the word that its predecessor wrote last; a word a cycle of the initial raster, and a beat of
    ``raster`` while its banks are free. With further planes each word with a pixel that passes the
    depth test takes its bank for a second cycle, so that an element takes 6 at most and one more;
    two words in four cycles of the initial raster, and of ``raster`` unless they are background.

    Members
    -------
    i : In(stream of FootprintLayout)
        Elements in the order of their lines. An ``end`` token is taken once nothing more comes of
        its frame's initial raster, and the frame before is out; then the next frame may follow.
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

        close = Signal()  # the end token is taken
        last_word = self.last_column[2:]
        m.d.comb += [
            walker.last_word.eq(last_word),
            walker.loaded.eq(loader.loaded),
            walker.jump.eq(loader.finished),
            walker.wipe.eq(sweeping),
            walker.wipe_row.eq(sweep[column_bits(config) :]),
            walker.restart.eq(self.finished),
            loader.enable.eq(self.load),
            loader.active.eq(self.active),
            loader.last_line.eq(self.last_line),
            loader.last_word.eq(last_word),
            loader.oldest.eq(walker.front),
            loader.restart.eq(close),
            # Of a frame that was closed, lines without words are passed over many at a time.
            loader.moves.eq(self.finished | walker.closing),
            close.eq(self.i.valid & footprint.end & loader.finished & ~walker.closing),
            walker.close.eq(close),
            self.closing.eq(walker.closing),
        ]
        if config.raster_words == 1:
            connect(m, flipped(self.initial), loader.i)
        else:
            m.submodules.halver = halver = Halver(config)
            connect(m, flipped(self.initial), halver.i)
            connect(m, halver.o, loader.i)

        # Request: the initial raster, else the element, and a flush in a bank that neither wants.
        top = Signal.like(footprint.top, init=-4)
        loading = Signal()
        flushing = Signal()
        ahead = Signal.like(top)
        held = Signal(BANKS)
        m.d.comb += [
            walker.top.eq(top),
            ahead.eq(footprint.top - walker.front),
            scatter.footprint.eq(footprint),
            scatter.go.eq(
                self.i.valid
                & ~footprint.end
                & running
                & ~sweeping
                & ~loader.o.valid
                & loader.loaded
                & (ahead < config.window_lines - BANKS)
                & paint.may_draw
            ),
            scatter.whole.eq(loader.o.valid),
            scatter.conflict.eq(Cat(bank.conflict for bank in banks) | held),
        ]
        with m.If(close):
            m.d.sync += top.eq(top.init)  # of the next frame
        with m.Elif(self.i.valid):
            m.d.sync += top.eq(footprint.top)

        service = Signal(FlushLayout(config))
        service_address = Signal.like(sweep)
        m.d.comb += [
            service.eq(walker.flush.payload),
            service_address.eq(Cat(service.pair, service.line[2:4])),
        ]
        with m.If(loader.o.valid):
            word, line = loader.o.payload.word, loader.o.payload.line
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
        m.d.comb += urgent.eq(~ahead[-1] & ahead[1:3].all() & emitter.ready)
        free = Signal(BANKS)  # for what is to be served
        for index, bank in enumerate(banks):
            drawn = scatter.requests[index]
            mine = Signal(name=f"service_{index}")
            wanted = Signal(name=f"wanted_{index}")
            has_line, half = service.line[:2] == index % 4, service.halves[index // 4]
            m.d.comb += [
                held[index].eq(urgent & has_line & (half | ~walker.flush.valid)),
                wanted.eq(scatter.go & scatter.want[index] & ~held[index]),
                mine.eq(has_line & half & ~wanted),
                free[index].eq(has_line & ~wanted & ~bank.conflict),
                bank.enable.eq(running),
                bank.request.address.eq(Mux(wanted, drawn.address, service_address)),
                bank.request.mask.eq(drawn.mask),
                bank.request.draw.eq(drawn.draw | (loading & mine)),
                bank.request.clear.eq((flushing & mine) | sweeping),
            ]
        served = Signal()
        m.d.comb += [
            served.eq((Cat(free[:4].any(), free[4:].any()) | ~service.halves).all()),
            loader.o.ready.eq(running & ~sweeping & paint.may_load & served),
            walker.flush.ready.eq(running & ~sweeping & ~loader.o.valid & emitter.ready & served),
            loading.eq(loader.o.valid & loader.o.ready),
            flushing.eq(walker.flush.valid & walker.flush.ready),
        ]

        # Stretches of marks that an element at hand lies in: that of its first word, and the next
        # one if its third word may lie there.
        stretch = footprint.word[column_bits(config) + 1 :]
        across = footprint.word[1 : column_bits(config) + 1].all()
        m.d.comb += [
            walker.reaching.eq(scatter.go),
            walker.reach.eq(
                Cat(
                    (stretch == number) | (across & (stretch == number - 1))
                    for number in range(len(walker.reach))
                )
            ),
        ]

        # Merge: what the banks draw, and the way out of what they give up.
        connect(m, emitter.raster, flipped(self.raster))
        m.d.comb += [
            paint.enable.eq(running),
            paint.z.eq(footprint.z),
            paint.shade.eq(footprint.colour),
            paint.load.eq(loader.o.valid),
            paint.loaded.eq(loader.o.payload.pixels),
            paint.drawing.eq(scatter.go),
            emitter.flush.eq(flushing),
            emitter.request.eq(service),
            emitter.last_column.eq(self.last_column),
            emitter.end.eq(walker.over),
            self.finished.eq(emitter.finished),
            self.i.ready.eq(scatter.done | close),
        ]
        for index, bank in enumerate(banks):
            m.d.comb += [
                bank.new.eq(paint.new[index % len(paint.new)]),
                emitter.words[index].eq(bank.old),
                walker.drawn[index].eq(bank.drawn),
                walker.addresses[index].eq(bank.drawn_address),
            ]
        return m
