"""The sliding window of the blocks engine, in rows of lanes: one element a cycle."""

from typing import NamedTuple

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import PixelLayout, RasterLayout
from splatline.rtl.window.loader import Loader
from splatline.rtl.window.service import (
    Clearing,
    connect_flush_scan,
    connect_frame_end,
    connect_loader,
    select_service,
)

from .dirty_bits import residue_bits
from .flush_scan import BlockFlushScan
from .lane_row import HALVES, LaneRow, RowRequestLayout, row_address_bits
from .layouts import BlockLayout, ClearedLayout, ColumnsLayout
from .plane_row import PlaneLaneRow
from .readout import BlockReadout
from .requests import register_columns, request_addresses, request_pixels, word_of

__all__ = ["BlockWindow"]


class Grants(NamedTuple):
    """Result of the arbitration in a cycle.

    Parameters
    ----------
    going
        The offered block is drawn.
    loading
        A word of the offered beat of the initial raster is loaded.
    odd
        It is the odd word.
    flushing
        The requested beat is flushed.
    service
        Word and line of the load or the flush, whether it goes or not.
    row_served
        Its row of lanes, one-hot.
    busy
        Rows of lanes that take the block's addresses.
    marks
        By row of lanes, if it is that of the flush scan's line: dirty bits may be taken.
    lone
        Rows of lanes without a block.
    """

    going: Value
    loading: Value
    odd: Value
    flushing: Value
    service: Value
    row_served: Value
    busy: Value
    marks: Value
    lone: Value


class BlockWindow(wiring.Component):
    """Draws blocks into a window of lines that slides down the image.

    The row of lanes of a pixel is the residue of its line modulo 8. Its lane in the row is the
    residue of its column modulo the pixels of a window word. A block therefore uses each lane at
    most once, wherever it lies. Each lane has two memories, for even and for odd words, so both
    words of a beat are flushed in one cycle (see :class:`LaneRow`).

    The pipeline never stalls. *Request*: each row gets an address for either half. *Read*: the
    memories read. *Catch*: the pixels are registered. *Test*: each lane compares depths and writes.
    A flushed beat goes to the FIFO of :class:`BlockReadout` instead.

    A load goes through the same pipeline, as blocks of a line do: each column of lanes has a value
    to write, the block's or its pixel of the word. It is written without a depth test.

    Arbitration: one block and one flush go in a cycle if they use different rows of lanes. On a
    conflict the block has priority, except while ``lagging``. A load goes alone, before all else:
    the even word of its beat, then the odd one, then nothing for a cycle. While ``raster`` is not
    ready, flushes stop once the FIFO is half full. Blocks go on as long as their lines are in the
    window.

    Hazards: none stalls. Each block comes with a comparison to the two blocks before it
    (``_follow``), by which a lane decides about pixels that are still being written. With planes
    lanes compare depths (:class:`PlaneLaneRow`). A block is drawn into a line, or a line flushed,
    three cycles after the last load in it at the soonest: the beat after it is compared meanwhile.

    After reset the lanes are cleared, in as many cycles as one of their memories has pixels.

    **Latency**: 8 cycles from a retired line to its first beat. **Throughput**: a block a cycle,
    less one cycle for each flush with priority, and two for each beat that is loaded. A load in
    three cycles. A dirty beat a cycle on ``raster``, less the cycles of blocks with priority and
    of loads.

    Members
    -------
    i : In(stream of BlockLayout)
        Blocks in the order of their lines. Their lines are in the window, as ``oldest``,
        ``cleared`` and ``empties`` said a cycle before (see :class:`BlockTiler`). An ``end`` token
        is taken once its frame's initial raster has ended and the frame before is out. Blocks of
        the next frame may follow it.
    shade : In(colour_bits)
        Colour of the block that is offered on ``i``.
    oldest : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded, in lines of the frame that is drawn:
        negative while the frame before leaves.
    cleared : Out(ClearedLayout)
        Slot of the beat that was requested in the cycle before. It is not cleared yet.
    empties : Out(1)
        If no block is offered, the window moves to ``top`` in this cycle. At most one beat is left,
        which is flushed in this cycle. Only the slot of its line is not free then.
    initial : In(stream of RasterLayout)
        Initial raster; read if ``load`` is set.
    raster : Out(stream of RasterLayout)
        The dirty beats, then an ``end`` beat.
    last_column, last_line : In
        Size of the image less 1; steady until ``finished``, as is ``load``.
    load : In(1)
        The frame starts from the initial raster.
    active : In(1)
        A frame is open: from its first code word until its ``end`` token is taken.
    closing : Out(1)
        A frame whose ``end`` token was taken is still leaving.
    finished : Out(1)
        High for one cycle: the frame's end beat goes into the FIFO.
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
        m.submodules.flush_scan = flush_scan = BlockFlushScan(config)
        m.submodules.loader = loader = Loader(config)
        m.submodules.readout = readout = BlockReadout(config)
        clearing = self._clear(m)
        close = self._connect_frame(m, flush_scan, loader, readout)
        grants = self._arbitrate(m, flush_scan, loader, readout, clearing.swept, close)
        new, again, behind = self._follow(m, grants)
        columns = register_columns(m, self, new, loader.o, grants.odd)
        requests = self._rows(m, flush_scan, readout, columns)
        request_pixels(m, self, requests, grants, again, behind, clearing.sweeping)
        request_addresses(m, self, requests, grants, clearing)
        self._mark(m, flush_scan, loader, grants, clearing)
        return m

    def _clear(self, m):
        """Clear the lanes after reset, address by address."""
        sweeping = Signal(init=1)
        sweep = Signal(row_address_bits(self.config))
        with m.If(sweeping):
            m.d.sync += [sweep.eq(sweep + 1), sweeping.eq(~sweep.all())]
        # Two cycles longer: the last pixels are still to be written.
        swept = Signal(init=1)
        just_swept = Signal(init=1)
        m.d.sync += [just_swept.eq(sweeping), swept.eq(sweeping | just_swept)]
        return Clearing(sweeping, sweep, swept)

    def _connect_frame(self, m, flush_scan, loader, readout):
        """Connect the rasters and the loader; return whether the frame's end token is taken."""
        config = self.config
        close = Signal()
        closable = Signal()  # a register, because every stage before the window waits for ``ready``
        front = Signal.like(flush_scan.front, name="front")
        beat = self.initial.payload
        connect(m, readout.raster, flipped(self.raster))
        m.d.comb += [
            loader.i.valid.eq(self.initial.valid),
            loader.i.payload.pixels.eq(beat.pixels),
            loader.i.payload.word.eq(Cat(0, beat.word)),
            loader.i.payload.line.eq(beat.line),
            loader.i.payload.end.eq(beat.end),
            self.initial.ready.eq(loader.i.ready),
        ]
        connect_loader(m, self, loader, front, close)
        closes = self.i.valid & self.i.payload.end & closable
        connect_frame_end(m, self, flush_scan, readout, close, closes)
        m.d.comb += [
            self.oldest.eq(Mux(loader.finished, flush_scan.front, loader.front)),
            # If no block is offered, the last beat is flushed in this cycle if there is room.
            self.empties.eq(flush_scan.empties & readout.room),
        ]
        m.d.sync += closable.eq(loader.finished & ~flush_scan.closing & ~close)
        # The window of the next frame is known a cycle after ``close``: until then it has no lines
        # for the loader. A block waits for what is still to be cleared on its own lines, and a
        # load need not wait: it is written after the clear.
        with m.If(close):
            m.d.sync += front.eq(-2 * config.window_lines)
        with m.Else():
            m.d.sync += front.eq(flush_scan.front)
        return close

    def _arbitrate(self, m, flush_scan, loader, readout, swept, close):
        """Grant a load; or a block and a flush, if they use different rows of lanes."""
        config = self.config
        block, load = self.i.payload, loader.o.payload
        bits = residue_bits(config)
        serving = Signal()  # the service is a load, not a flush
        service = select_service(m, self, flush_scan.flush.payload, load, serving)
        row_served = Signal(BLOCK)  # its row of lanes
        m.d.comb += row_served.eq(1 << service.line[:bits])

        offered = Signal()
        going = Signal()
        loading = Signal()
        flushing = Signal()
        wanted = Signal(BLOCK)  # rows of lanes that the block draws into
        meeting = Signal()  # one of ``wanted`` is the flush's
        marking = Signal()  # one of ``wanted`` is the dirty bits'
        leaves = Signal()  # a flush is requested, and there is room for it
        lagging = Signal()
        first = Signal()
        marks_first = Signal()
        odd = Signal()  # of the load's beat the odd word goes
        reserved = Signal(BLOCK)  # rows of lanes that an offered block draws into
        busy = Signal(BLOCK)
        m.d.comb += [
            # Until all is cleared, the lanes' addresses are those of the clearing.
            offered.eq(self.i.valid & ~block.end & ~serving & ~swept),
            going.eq(offered & ~(first & meeting) & ~(marks_first & marking)),
            self.i.ready.eq(going | close),
            wanted.eq(block.rows),
            meeting.eq((wanted & flush_scan.oldest_row).any()),
            marking.eq((wanted & flush_scan.line_row).any()),
            leaves.eq(flush_scan.flush.valid & readout.room),
            first.eq(leaves & lagging),
            marks_first.eq(flush_scan.takes & lagging),
            # ``going`` is late, so the block's rows are reserved whether it goes or not.
            reserved.eq(wanted & offered.replicate(BLOCK)),
            busy.eq(reserved & ~(row_served & first.replicate(BLOCK))),
            serving.eq(loader.o.valid),
            loading.eq(serving & ~swept),
            loader.o.ready.eq(loading & odd),
            flushing.eq(flush_scan.flush.valid & flush_scan.flush.ready),
            flush_scan.flush.ready.eq(readout.room & ~serving & (first | ~(offered & meeting))),
            readout.flush.eq(flushing),
            readout.place.eq(flush_scan.flush.payload),
        ]
        m.d.sync += [
            self.cleared.valid.eq(flushing),
            self.cleared.place.eq(flush_scan.flush.payload.line[: config.slot_bits]),
        ]
        m.d.sync += [
            odd.eq(loading & ~odd),
            # A register, because every stage before the window waits for a block to go.
            lagging.eq(self._lags(m, flush_scan)),
        ]
        return Grants(
            going=going,
            loading=loading,
            odd=odd,
            flushing=flushing,
            service=service,
            row_served=row_served,
            busy=busy,
            marks=~serving.replicate(BLOCK) & (marks_first.replicate(BLOCK) | ~reserved),
            lone=~reserved,
        )

    def _lags(self, m, flush_scan):
        """Return whether a flush has priority over a block.

        Elements of up to four lines lie about the fifth line from ``top`` on. They leave the rows
        of the lines one and two above ``top`` free, and flushes of these lines go beside them.
        Flushes of lines further above have priority, so that the flush scan comes to those lines.
        With priority for all lines no flush would be left to go beside the elements.
        """
        above = Signal(3)
        m.d.comb += above.eq(self.i.payload.top[:3] - flush_scan.oldest[:3])
        return above >= 2

    def _rows(self, m, flush_scan, readout, new):
        """Add the rows of lanes; return the registers of their requests.

        The registers cut two long paths: the one to an address, and the one from there to the
        many lanes.
        """
        config = self.config
        rows = [PlaneLaneRow(config) if config.plane else LaneRow(config) for _ in range(BLOCK)]
        requests = [
            Signal(RowRequestLayout(config), name=f"request_{q}", reset_less=True)
            for q in range(BLOCK)
        ]
        outside = self._outside(m, flush_scan.flush.payload.word)
        if config.plane:
            columns = Signal(ColumnsLayout(config), reset_less=True)
            m.d.sync += columns.eq(self.i.payload.columns)
        for q, (row, request) in enumerate(zip(rows, requests, strict=True)):
            m.submodules[f"row_{q}"] = row
            m.d.comb += [
                row.request.eq(request),
                row.new.eq(new),
                row.outside.eq(outside),
                readout.rows[q].eq(row.leaving),
            ]
            if config.plane:
                m.d.comb += row.columns.eq(columns)
        return requests

    def _mark(self, m, flush_scan, loader, grants, clearing):
        """Tell the flush scan which words are written, and when it may take dirty bits."""
        config = self.config
        block, load = self.i.payload, loader.o.payload
        for q in range(BLOCK):
            group = load.line[residue_bits(config) : config.slot_bits]
            m.d.comb += flush_scan.group[q].eq(Mux(flush_scan.lone[q], group, block.group[q]))
        m.d.comb += flush_scan.top.eq(block.top)
        connect_flush_scan(m, self, flush_scan, loader, grants.marks, clearing)
        m.d.comb += [
            flush_scan.drawing.eq(grants.going),
            flush_scan.words.eq(block.words),
            flush_scan.touch.eq(block.touch),
            flush_scan.reaching.eq(self.i.valid & ~block.end),
            flush_scan.load.eq(grants.row_served & grants.loading.replicate(BLOCK)),
            flush_scan.load_word.eq(load.word),
            # A row without a block takes the load's address, whether the load goes or not.
            flush_scan.lone.eq(grants.lone),
        ]

    def _follow(self, m, grants):
        """Compare the block with the two before it; return the earlier pixel, and the results.

        The results are ``again`` and ``behind`` of :class:`RowRequestLayout`. The pixel is that of
        the cycle before, and zeros if that was a load's. With planes only its colour counts.
        """
        config, block = self.config, self.i.payload
        words = data.StructLayout(dict.fromkeys(HALVES, config.word_bits - 1))
        past = data.StructLayout({"drawn": 1, "new": PixelLayout(config), "words": words})
        latest, before, before_that = (
            Signal(past, name=f"drawn_{n}", reset_less=n > 0) for n in range(3)
        )
        again = Signal(RowRequestLayout(config).members["again"])
        behind = Signal(2)
        m.d.comb += [
            latest.drawn.eq(grants.going),
            latest.new.depth.eq(block.z),
            latest.new.colour.eq(self.shade),
        ]
        for half, name in enumerate(HALVES):
            m.d.comb += getattr(latest.words, name).eq(word_of(block, half))
        m.d.sync += [before.eq(latest), before_that.eq(before)]
        with m.If(grants.loading):
            m.d.sync += before.new.eq(0)
        for n, other in enumerate((before, before_that)):
            # The depth of what was not offered may be undefined.
            known = self.i.valid & other.drawn
            m.d.comb += behind[n].eq(known & (block.z >= other.new.depth))
            for name in HALVES:
                same = getattr(latest.words, name) == getattr(other.words, name)
                m.d.comb += getattr(again[n], name).eq(other.drawn & same)
        return before.new, again, behind

    def _outside(self, m, word):
        """Return which pixels of the requested beat lie outside the right border.

        Elements are clipped by whole words only. ``word``: word of the beat requested next.
        """
        config = self.config
        bits = config.pixel_bits + 1
        requested = Signal(len(word) - 1, reset_less=True)
        m.d.sync += requested.eq(word[1:])
        is_last = requested == self.last_column[bits:]
        return Cat(is_last & (n > self.last_column[:bits]) for n in range(config.raster_pixels))
