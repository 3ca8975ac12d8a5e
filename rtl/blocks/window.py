"""The sliding window in rows of lanes: an element a cycle, whatever its size."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import PixelLayout, PlaceLayout, RasterLayout
from splatline.rtl.window.loader import Loader

from .dirty_bits import residue_bits
from .flush_scan import BlockFlushScan
from .lane_row import HALVES, BeatWordsLayout, LaneRow, RowRequestLayout, row_address_bits
from .layouts import BlockLayout, ClearedLayout
from .readout import BlockReadout

__all__ = ["BlockWindow"]


class BlockWindow(wiring.Component):
    """Draws blocks into a window of lines that slides down the image.

    A line's row of lanes is its residue modulo 8, a pixel's lane in it that of its column modulo a
    word's pixels; so a block has each lane once, wherever it lies. Each lane has two memories, for
    even words and for odd ones, and both words of a beat leave at once (see :class:`LaneRow`).
    Stages, and what they hold goes on in every cycle: *request* (who may go; an address a row and
    half), *read*, *catch*, and *test* (the lanes write over what is behind), or *emit* in its place
    (what was flushed waits for ``raster`` in a queue, see :class:`BlockReadout`). A block and a
    beat that is flushed go together if their rows differ; if not, the block goes first, or the beat
    (see ``lagging``). In place of that beat one of the initial raster goes, into a row that the
    block leaves free, or alone (see ``pressing``). Where ``raster`` takes nothing, beats are
    flushed until the queue is half full, and blocks go on as long as their lines are in the window.

    Blocks follow each other whatever pixels they have in common: each is told what the two before
    it have. After reset the lanes are cleared, which takes as many cycles as one of their memories
    has pixels.

    **Latency**: 8 cycles from a retired line to its first beat. **Throughput**: a block a cycle but
    for beats that go first; a beat of the initial raster in two cycles; and a beat a cycle of
    ``raster``, of those that were written, but for blocks that go first.

    Members
    -------
    i : In(stream of BlockLayout)
        Blocks in the order of their lines, which are there, as :class:`BlockTiler` has it, by what
        ``oldest``, ``cleared`` and ``empties`` said a cycle before it came. An ``end`` token is
        taken once nothing more comes of its frame's initial raster, and the frame before is out;
        then blocks of the next frame may follow.
    shade : In(colour_bits)
        Colour of the block that is offered on ``i``.
    oldest : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded, of the frame that is drawn: negative while
        one leaves.
    cleared : Out(ClearedLayout)
        A beat of that line was asked for in the cycle before, and is not cleared yet.
    empties : Out(1)
        Nothing is left in the window but a beat of its first line that leaves in this cycle, if no
        block is offered: then it comes to ``top``, and only the place of that line is not free.
    initial : In(stream of RasterLayout)
        Initial raster; read if ``load`` is set.
    raster : Out(stream of RasterLayout)
        The beats in which something was drawn, then an ``end`` beat.
    last_column, last_line : In
        Size of the image less 1; steady until ``finished``, as is ``load``.
    load : In(1)
        The frame starts from the initial raster.
    active : In(1)
        A frame is open: from its first code word until its ``end`` token is taken.
    closing : Out(1)
        A frame whose ``end`` token was taken is not out.
    finished : Out(1)
        High for one cycle: the frame's end beat goes into the queue.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(BlockLayout(config))),
                "shade": In(config.colour_bits),
                "oldest": Out(signed(config.line_bits + 2)),
                "empties": Out(1),
                "cleared": Out(ClearedLayout(config)),
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
        block = self.i.payload
        bits = residue_bits(config)

        m.submodules.flush_scan = flush_scan = BlockFlushScan(config)
        m.submodules.loader = loader = Loader(config)
        m.submodules.readout = readout = BlockReadout(config)
        close = Signal()  # the end token is taken
        closable = Signal()  # it may be: known a cycle ahead, as much waits for who is taken
        ending = Signal()
        front = Signal.like(flush_scan.front, name="front")

        sweeping = Signal(init=1)
        sweep = Signal(row_address_bits(config))
        with m.If(sweeping):
            m.d.sync += [sweep.eq(sweep + 1), sweeping.eq(~sweep.all())]
        # In one of the two cycles before: the last pixels are still to be written.
        swept, just_swept = Signal(init=1), Signal(init=1)
        m.d.sync += [just_swept.eq(sweeping), swept.eq(sweeping | just_swept)]

        beat, load = self.initial.payload, loader.o.payload
        connect(m, readout.raster, flipped(self.raster))
        m.d.comb += [
            loader.i.valid.eq(self.initial.valid),
            loader.i.payload.pixels.eq(beat.pixels),
            loader.i.payload.word.eq(Cat(0, beat.word)),
            loader.i.payload.line.eq(beat.line),
            loader.i.payload.end.eq(beat.end),
            self.initial.ready.eq(loader.i.ready),
            loader.enable.eq(self.load),
            loader.active.eq(self.active),
            loader.last_line.eq(self.last_line),
            loader.last_word.eq(self.last_column[config.pixel_bits :]),
            loader.oldest.eq(front),
            loader.restart.eq(close),
            readout.end.eq(ending),
            self.finished.eq(readout.finished),
            close.eq(self.i.valid & block.end & closable),
            flush_scan.close.eq(close),
            self.closing.eq(flush_scan.closing),
            self.oldest.eq(Mux(loader.finished, flush_scan.front, loader.front)),
            # While none is offered that beat goes at once, if there is room.
            self.empties.eq(flush_scan.empties & readout.room),
        ]
        m.d.sync += [
            ending.eq(flush_scan.over & ~self.finished),
            closable.eq(loader.finished & ~flush_scan.closing & ~close),
        ]
        # A beat that left a cycle ago is still to be cleared. Loading waits that long for any; an
        # element for those in its place alone. Which lines are in the window of the next frame is
        # known a cycle after its ``close``: until then none of them.
        with m.If(close):
            m.d.sync += front.eq(-2 * config.window_lines)
        with m.Else():
            m.d.sync += front.eq(flush_scan.front)

        # What is served beside the block: a beat of the initial raster, or one that leaves.
        service = Signal(PlaceLayout(config))
        serving = Signal()  # the former
        m.d.comb += service.eq(flush_scan.flush.payload)
        with m.If(serving):
            m.d.comb += [service.word.eq(load.word), service.line.eq(load.line)]
        row_served = Signal(BLOCK)  # the row of lanes that it lies in
        m.d.comb += row_served.eq(1 << service.line[:bits])

        # Who may go: the block, and a load or a flush, in rows of lanes that differ.
        offered, going, loading, flushing = Signal(), Signal(), Signal(), Signal()
        wanted = Signal(BLOCK)  # rows of lanes where the block has pixels
        meeting, marking = Signal(), Signal()  # it wants the row of what leaves, of marks
        leaves = Signal()  # a beat that is asked for, if nothing goes before it
        lagging, first, marks_first = Signal(), Signal(), Signal()
        pressing = Signal()  # a beat of the initial raster goes, and no block
        refused = Signal()  # a beat of the initial raster, in the cycle before
        busy = Signal(BLOCK)
        m.d.comb += [
            # Until all is swept the lanes' addresses are the sweep's.
            offered.eq(self.i.valid & ~block.end & ~pressing & ~swept),
            going.eq(offered & ~(first & meeting) & ~(marks_first & marking)),
            self.i.ready.eq(going | close),
            wanted.eq(block.rows),
            meeting.eq(wanted.bit_select(flush_scan.flush.payload.line[:bits], 1)),
            marking.eq(wanted.bit_select(flush_scan.line[:bits], 1)),
            leaves.eq(flush_scan.flush.valid & readout.room),
            first.eq(leaves & lagging),
            marks_first.eq(flush_scan.takes & lagging),
            # Whether the block goes is known late; its lanes are kept for it in any case.
            busy.eq(wanted & offered.replicate(BLOCK) & ~(row_served & first.replicate(BLOCK))),
            # In turn with beats that leave, where one of the two is refused.
            serving.eq(loader.o.valid & (pressing | ~(leaves & (refused | lagging)))),
            loading.eq(serving & ~swept & ~(offered & wanted.bit_select(load.line[:bits], 1))),
            loader.o.ready.eq(loading),
            flushing.eq(flush_scan.flush.valid & flush_scan.flush.ready),
            flush_scan.flush.ready.eq(readout.room & ~serving & (first | ~(offered & meeting))),
            readout.flush.eq(flushing),
            readout.place.eq(flush_scan.flush.payload),
        ]
        m.d.sync += [
            self.cleared.valid.eq(flushing),
            self.cleared.place.eq(flush_scan.flush.payload.line[: config.slot_bits]),
        ]
        # Which of them goes first. Elements of up to four lines lie about the fifth line from
        # ``top`` on and leave the rows of the lines one and two above ``top``: those leave beside
        # them. What lies further above goes first, so that it comes to that; were all to go first,
        # there would be none left to leave beside the elements. Of what is loaded the lines 6 and 7
        # below ``top``, modulo 8, go beside them, in the rows of those two; others go first.
        above, distance = Signal(3), Signal(3)
        m.d.comb += [
            above.eq(block.top[:3] - flush_scan.oldest[:3]),
            distance.eq(load.line[:3] - block.top[:3]),
        ]
        m.d.sync += [
            lagging.eq(above >= 2),
            # Known a cycle ahead, as all before a block waits for it. Marks that go before a block
            # are not taken beside what is offered to load, and that may want the block's row: so it
            # goes where lines lag, or none of the three ever would.
            pressing.eq(serving & ~loading & ((distance < 6) | lagging)),
            refused.eq(serving & ~loading),
        ]

        rows = [LaneRow(config) for _ in range(BLOCK)]
        # What goes is requested in the next cycle: the way to an address is long, and so is the one
        # from there to the lanes, of which there are many.
        requests = [
            Signal(RowRequestLayout(config), name=f"request_{q}", reset_less=True)
            for q in range(BLOCK)
        ]
        loaded = Signal(BeatWordsLayout(config), reset_less=True)
        new, again, behind = self._follow(m, going)
        outside = self._outside(m, flush_scan.flush.payload.word)
        for q, (row, request) in enumerate(zip(rows, requests, strict=True)):
            m.submodules[f"row_{q}"] = row
            m.d.comb += [
                row.request.eq(request),
                row.new.eq(new),
                row.loaded.eq(loaded),
                row.outside.eq(outside),
                readout.rows[q].eq(row.leaving),
            ]
            m.d.sync += [
                request.draw.eq(going),
                request.mask.eq(block.mask[q]),
                request.odd.eq(block.odd[q]),
                request.again.eq(again),
                request.behind.eq(behind),
                request.load.eq(loading & row_served[q]),
                request.clear.eq((flushing & row_served[q]) | sweeping),
            ]
        place = Signal(row_address_bits(config))
        m.d.comb += place.eq(
            Mux(sweeping, sweep, Cat(service.word[1:], service.line[bits : config.slot_bits]))
        )
        for half, name in enumerate(HALVES):
            m.d.sync += [
                getattr(request.addresses, name).eq(
                    Mux(busy[q], Cat(_word(block, half), block.group[q]), place)
                )
                for q, request in enumerate(requests)
            ]
            left = config.pixels_per_word * half
            m.d.sync += [
                getattr(loaded, name)[kind][column].eq(load.pixels[kind][left + column])
                for kind in ("depth", "colour")
                for column in range(config.pixels_per_word)
            ]

        # The words that are written, for the flush scan.
        for q in range(BLOCK):
            group = load.line[bits : config.slot_bits]
            m.d.comb += flush_scan.group[q].eq(Mux(flush_scan.lone[q], group, block.group[q]))
        m.d.comb += [
            flush_scan.top.eq(block.top),
            flush_scan.limit.eq(loader.limit),
            flush_scan.jump.eq(loader.finished),
            # Whether a beat that is offered is loaded is known late.
            flush_scan.enable.eq(~serving & (marks_first | ~(offered & marking))),
            flush_scan.wipe.eq(sweeping),
            flush_scan.wipe_row.eq(sweep),
            flush_scan.restart.eq(self.finished),
            flush_scan.drawing.eq(going),
            flush_scan.words.eq(block.words),
            flush_scan.touch.eq(block.touch),
            flush_scan.reaching.eq(self.i.valid & ~block.end),
            flush_scan.load.eq(row_served & loading.replicate(BLOCK)),
            flush_scan.load_word.eq(load.word),
            # Where no block draws, what would be loaded is what would be marked.
            flush_scan.lone.eq(~(wanted & offered.replicate(BLOCK))),
        ]
        return m

    def _follow(self, m, going):
        """Return what was drawn two cycles before, and what of a block's request says so.

        That is ``again`` and ``behind``.
        """
        block = self.i.payload
        words = data.StructLayout(dict.fromkeys(HALVES, self.config.word_bits - 1))
        past = data.StructLayout({"drawn": 1, "new": PixelLayout(self.config), "words": words})
        latest, before, before_that = (
            Signal(past, name=f"drawn_{n}", reset_less=n > 0) for n in range(3)
        )
        again = Signal(RowRequestLayout(self.config).members["again"])
        behind = Signal(2)
        m.d.comb += [
            latest.drawn.eq(going),
            latest.new.depth.eq(block.z),
            latest.new.colour.eq(self.shade),
        ]
        for half, name in enumerate(HALVES):
            m.d.comb += getattr(latest.words, name).eq(_word(block, half))
        m.d.sync += [before.eq(latest), before_that.eq(before)]
        for n, other in enumerate((before, before_that)):
            # The depth of what was not offered may be undefined.
            known = self.i.valid & other.drawn
            m.d.comb += behind[n].eq(known & (block.z >= other.new.depth))
            for name in HALVES:
                same = getattr(latest.words, name) == getattr(other.words, name)
                m.d.comb += getattr(again[n], name).eq(other.drawn & same)
        return before_that.new, again, behind

    def _outside(self, m, word):
        """Return which pixels of the beat that is requested lie beyond the right border.

        As elements are clipped by words. ``word`` is that of the next one.
        """
        config = self.config
        bits = config.pixel_bits + 1
        requested = Signal(len(word) - 1, reset_less=True)
        m.d.sync += requested.eq(word[1:])
        is_last = requested == self.last_column[bits:]
        return Cat(is_last & (n > self.last_column[:bits]) for n in range(config.raster_pixels))


def _word(block, half):
    """Return the number of a block's even word, or its odd one, among those of its line.

    Of its two words the first one is the odd one, or both have one number.
    """
    return block.words[1 - half][1:]
