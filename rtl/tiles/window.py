"""The sliding window of the tiles engine, in lanes of pixels: the smallest for small elements."""

from typing import NamedTuple

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout, RasterLayout
from splatline.rtl.window.loader import Loader
from splatline.rtl.window.service import (
    Clearing,
    connect_flush_scan,
    connect_frame_end,
    connect_loader,
    select_service,
)

from .flush_scan import TileFlushScan
from .lane import Lane, lane_address_bits
from .layouts import TileLayout
from .readout import TileReadout

__all__ = ["TileWindow"]

SIDE = 4
"""Lines of a tile."""


class Service(NamedTuple):
    """The service beside a tile: a load or a flush.

    Parameters
    ----------
    asks
        A flush is requested, and its lanes are free of the flush before.
    serving
        The service is a load.
    place
        Word and line of the service, whether it goes or not.
    row
        Its row of lanes, one-hot.
    """

    asks: Value
    serving: Value
    place: Value
    row: Value


class Grants(NamedTuple):
    """Result of the arbitration in a cycle.

    Parameters
    ----------
    offered
        A tile is offered, whether it is drawn or not.
    going
        It is drawn.
    loading
        The offered word of the initial raster is loaded.
    flushing
        The requested word is flushed.
    busy
        Rows of lanes that take the tile's addresses.
    lone
        Rows of lanes without a tile.
    """

    offered: Value
    going: Value
    loading: Value
    flushing: Value
    busy: Value
    lone: Value


class TileWindow(wiring.Component):
    """Draws tiles into a window of lines that slides down the image.

    The lane of a pixel is the residue of its line modulo 4, and of its column modulo the pixels of
    a window word. A tile therefore uses each lane at most once, wherever it lies.

    The pipeline has three stages. *Request*: each lane gets an address. *Write*: each lane compares
    depths and writes; a flushed word is on its lanes' outputs. *Emit*: the word waits on
    ``raster``. All three stages stall while ``raster`` takes nothing.

    Arbitration: one tile and one service, a flush or a load, go in a cycle if they use different
    rows of lanes. On a conflict the tile has priority over a flush, except while ``lagging``; and
    over a load, except while ``pressing``, when the load goes alone.

    Hazards: a tile stalls for one cycle if it shares a pixel with the tile before it. No tile goes
    while dirty bits are taken.

    With simple memories a load takes the tile's way to the lanes, so it goes alone, and its pixels
    are written a cycle later. Nobody asks for them before: their line counts as loaded once the
    loader sees a beat of another line.

    With ``flush_words`` 2 a flush is for a pair of words. It uses its lanes for one cycle and
    ``raster`` for two, so a tile can go between two pairs. While dirty bits are taken, a tile can
    go if it does not use the row of lanes of their line.

    After reset the lanes are cleared, in as many cycles as a lane has pixels.

    **Latency**: 5 cycles from a retired line to its first beat. **Throughput**: a tile a cycle,
    less one cycle for a hazard, for each stretch of 32 words whose dirty bits are taken (see
    :class:`TileFlushScan`) and for each service with priority. A load in two cycles. A dirty word a
    cycle on ``raster``, less the cycles of the flush scan, of tiles with priority and of loads.

    Members
    -------
    i : In(stream of TileLayout)
        Tiles in the order of their lines. Their lines are in the window that begins at ``oldest``,
        and were in it a cycle before. An ``end`` token is taken once its frame's initial raster has
        ended and the frame before is out. Tiles of the next frame may follow it.
    shade : In(colour_bits)
        Colour of the tile that is offered on ``i``.
    oldest : Out(signed(line_bits + 2))
        First line of the window as far as it was loaded, in lines of the frame that is drawn:
        negative while the frame before leaves.
    initial : In(stream of RasterLayout)
        Initial raster; read if ``load`` is set.
    raster : Out(stream of RasterLayout)
        The dirty words, then an ``end`` beat.
    last_column, last_line : In
        Size of the image less 1; steady until ``finished``, as is ``load``.
    load : In(1)
        The frame starts from the initial raster.
    active : In(1)
        A frame is open: from its first code word until its ``end`` token is taken.
    closing : Out(1)
        A frame whose ``end`` token was taken is still leaving.
    finished : Out(1)
        High for one cycle: the frame's end beat goes into the emit stage.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(TileLayout(config))),
                "shade": In(config.colour_bits),
                "oldest": Out(signed(config.line_bits + 2)),
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
        m.submodules.flush_scan = flush_scan = TileFlushScan(self.config)
        m.submodules.loader = loader = Loader(self.config)
        m.submodules.readout = readout = TileReadout(self.config)
        lanes = self._lanes(m)
        clearing = self._clear(m)
        close = self._connect_frame(m, flush_scan, loader, readout)
        service = self._service(m, flush_scan, loader, readout)
        m.d.comb += [flush_scan.top.eq(self.i.payload.top), self.oldest.eq(loader.front)]
        connect_flush_scan(m, self, flush_scan, loader, ~clearing.sweeping, clearing)
        grants = self._arbitrate(m, flush_scan, loader, readout, service, clearing, close)
        self._connect_lanes(m, lanes, loader, readout, service, grants, clearing)
        self._touch(m, flush_scan, grants.going)
        self._touch_loaded(m, flush_scan, loader.o.payload, service, grants)
        return m

    def _clear(self, m):
        """Clear the lanes after reset, address by address."""
        sweeping = Signal(init=1)
        sweep = Signal(lane_address_bits(self.config))
        with m.If(sweeping):
            m.d.sync += [sweep.eq(sweep + 1), sweeping.eq(~sweep.all())]
        swept = Signal(init=1)  # a cycle later: the last pixels are still to be written
        m.d.sync += swept.eq(sweeping)
        return Clearing(sweeping, sweep, swept)

    def _connect_frame(self, m, flush_scan, loader, readout):
        """Connect the rasters and the loader; return whether the frame's end token is taken."""
        close = Signal()
        connect(m, flipped(self.initial), loader.i)
        connect(m, readout.raster, flipped(self.raster))
        connect_loader(m, self, loader, flush_scan.front, close)
        m.d.comb += readout.last_column.eq(self.last_column)
        closes = self.i.valid & self.i.payload.end & loader.finished & ~flush_scan.closing
        connect_frame_end(m, self, flush_scan, readout, close, closes)
        return close

    def _service(self, m, flush_scan, loader, readout):
        """Select the service beside the tile: a load or a flush."""
        serving = Signal()
        service = select_service(m, self, flush_scan.flush.payload, loader.o.payload, serving)
        line = Signal(SIDE)
        m.d.comb += line.eq(1 << service.line[:2])
        asks = flush_scan.flush.valid
        if self.config.flush_words == 2:
            asks = Signal()  # not while the odd word of the pair before waits for its lanes
            m.d.comb += asks.eq(flush_scan.flush.valid & ~readout.busy)
        return Service(asks, serving, service, line)

    def _arbitrate(self, m, flush_scan, loader, readout, service, clearing, close):
        """Grant a tile, and a load or a flush, if they use different rows of lanes."""
        tile, running = self.i.payload, readout.running
        asks, serving, place, line = service
        sweeping, _, swept = clearing
        offered = Signal()
        going = Signal()
        loading = Signal()
        flushing = Signal()
        wanted = Signal(SIDE)  # rows of lanes that the tile draws into
        first = Signal()
        meeting = Signal()
        lagging = Signal()
        pressing = Signal()  # a load goes, and no tile
        drawn = Signal()  # a tile went in the cycle before
        refused = Signal()  # a load was refused in the cycle before
        conflict = Signal()
        stopped = Signal()
        busy = Signal(SIDE)
        taking = flush_scan.taking
        if self.config.flush_words == 2:
            taking = flush_scan.taking & meeting
        m.d.comb += [
            offered.eq(self.i.valid & ~tile.end & ~pressing),
            going.eq(offered & running & ~swept & ~taking & ~conflict & ~(first & meeting)),
            # Read-after-write hazard: the lanes still write the tile of the cycle before. After a
            # stall they may also still clear a flushed word.
            conflict.eq((drawn & tile.meets) | stopped),
            self.i.ready.eq(going | close),
            first.eq(asks & lagging),
            meeting.eq(wanted.bit_select(flush_scan.oldest[:2], 1)),
            # ``going`` is late, so the tile's lanes are reserved whether it goes or not.
            wanted.eq(Cat(row.any() for row in tile.mask)),
            busy.eq(wanted & offered.replicate(SIDE) & ~(line & first.replicate(SIDE))),
            # A load that was refused gives way to a flush, so the two alternate.
            serving.eq(loader.o.valid & (pressing | ~(asks & (refused | lagging)))),
            # After a stall the line whose slot the load takes may have left, while its last word is
            # still cleared. Then both ports of a lane would write one pixel.
            loading.eq(
                serving
                & running
                & ~sweeping
                & ~swept
                & ~stopped
                & ~flush_scan.taking
                & ~(offered & wanted.bit_select(loader.o.payload.line[:2], 1))
            ),
            loader.o.ready.eq(loading),
            flushing.eq(flush_scan.flush.valid & flush_scan.flush.ready),
            flush_scan.flush.ready.eq(
                running
                & ~sweeping
                & ~serving
                & (first | ~(offered & meeting))
                # After a stall the tile's line may be retired while its pixels are still written.
                & ~(stopped & drawn)
            ),
            readout.flush.eq(flushing),
            readout.place.eq(place),
        ]
        if self.config.flush_words == 2:
            with m.If(readout.busy):
                m.d.comb += flush_scan.flush.ready.eq(0)
        if self.config.memory == "simple":
            with m.If(offered):
                m.d.comb += loading.eq(0)
        m.d.sync += stopped.eq(~running)
        flush_first, load_first = self._priorities(m, flush_scan, loader)
        # Registers, because every stage before the window waits for a tile to go.
        m.d.sync += [
            lagging.eq(flush_first),
            pressing.eq(serving & ~loading & load_first),
        ]
        with m.If(running):
            m.d.sync += drawn.eq(going)
        m.d.sync += refused.eq(serving & ~loading)
        lone = ~(wanted & offered.replicate(SIDE))
        return Grants(offered, going, loading, flushing, busy, lone)

    def _lanes(self, m):
        """Return the lanes, by residue of line and column."""
        lanes = [
            [Lane(self.config) for _ in range(self.config.pixels_per_word)] for _ in range(SIDE)
        ]
        for i, row in enumerate(lanes):
            for j, lane in enumerate(row):
                m.submodules[f"lane_{i}_{j}"] = lane
        return lanes

    def _priorities(self, m, flush_scan, loader):
        """Return whether a flush has priority over a tile, and whether a load has.

        Elements of up to three lines leave one row of lanes free: that of the line two above
        ``top``. A flush of this line goes beside them. A flush of the line three above, modulo 4,
        has priority, and so has one of the line two above, whose row larger elements use. With
        priority for all lines no flush would be left to go beside the elements, and each would
        delay the elements of the line that completes it.

        A load of the line ten below ``top`` goes beside the elements, in the same row of lanes.
        Loads of the two lines before it have priority, so that its turn comes. So have loads of
        the two lines before those, because tiles may wait for them.
        """
        top = self.i.payload.top
        distance = Signal(3)
        m.d.comb += distance.eq(loader.o.payload.line[:3] - top[:3])
        return (top[:2] - flush_scan.oldest[:2])[1], (distance < 2) | (distance > 5)

    def _connect_lanes(self, m, lanes, loader, readout, service, grants, clearing):
        """Request of each lane its pixel of the tile, of the service or of the clearing."""
        tile = self.i.payload
        sweeping, sweep, _ = clearing
        simple = self.config.memory == "simple"
        loaded = loader.o.payload.pixels
        drawing = self._draw(m, readout.running, grants.offered, loaded.colour)
        cleared = (~service.serving | sweeping).replicate(self.config.depth_bits)
        for i, row in enumerate(lanes):
            loads, clears = grants.loading & service.row[i], grants.flushing & service.row[i]
            written = clears | sweeping | loads if simple else clears | sweeping
            for j, lane in enumerate(row):
                address = self._address(m, i, j, grants.busy, service.place)
                m.d.comb += [
                    lane.enable.eq(readout.running),
                    lane.request.address.eq(Mux(sweeping, sweep, address)),
                    lane.request.draw.eq(grants.going & tile.mask[i][j]),
                    *([] if simple else [lane.request.load.eq(loads)]),
                    lane.request.clear.eq(written),
                    lane.new.eq(drawing[j]),
                ]
                if simple or self.config.plane:
                    name, init = f"depth_{i}_{j}", self.config.background_depth * simple
                    depth = Signal(self.config.depth_bits, name=name, init=init, reset_less=True)
                    given = tile.depth[i][j] if self.config.plane else tile.z
                    given = Mux(grants.offered, given, loaded.depth[j]) if simple else given
                    self._draw_depth(m, depth, given, readout.running, clears | sweeping)
                    m.d.comb += lane.new.depth.eq(depth)
                if self.config.flush_words == 2:
                    # Clearing after reset takes one pixel a cycle.
                    m.d.comb += [
                        lane.request.load.eq(loads | sweeping),
                        lane.request.clear.eq(clears),
                    ]
                self._connect_pixels(m, i, j, lane, loader, readout, cleared)

    def _draw(self, m, running, offered, loaded):
        """Return the pixel that the lanes of each column draw: depth and colour of the tile.

        With simple memories it has the colour alone: the loaded one while no tile is offered.
        """
        tile = self.i.payload
        columns = range(self.config.pixels_per_word)
        if self.config.memory == "simple":
            pixels = [
                Signal(PixelLayout(self.config), name=f"drawing_{j}", reset_less=True)
                for j in columns
            ]
            with m.If(running):
                m.d.sync += [
                    pixels[j].colour.eq(Mux(offered, self.shade, loaded[j])) for j in columns
                ]
            return pixels
        drawing = Signal(PixelLayout(self.config), reset_less=True)
        with m.If(running):
            m.d.sync += drawing.colour.eq(self.shade)
            if not self.config.plane:
                # An undefined depth on an idle input would make a lane's sum undefined, and with it
                # the write enable of the clearing after reset.
                m.d.sync += drawing.depth.eq(Mux(self.i.valid, tile.z, 0))
        return [drawing for _ in columns]

    def _draw_depth(self, m, depth, given, running, clears):
        """Set a lane's depth: that of its pixel, or at a clear the background's.

        The flip-flops have a synchronous set, which takes no LUT.
        """
        with m.If(running & clears):
            m.d.sync += depth.eq(~0)
        with m.Elif(running):
            m.d.sync += depth.eq(given)

    def _address(self, m, i, j, busy, place):
        """Return the address of a lane: of the tile's pixel, or of the word that is served."""
        tile = self.i.payload
        word = Mux(tile.next[j], tile.words[1], tile.words[0])
        group = place.line[2 : self.config.slot_bits]
        address = Signal(lane_address_bits(self.config), name=f"address_{i}_{j}")
        m.d.comb += address.eq(Mux(busy[i], Cat(word, tile.group[i]), Cat(place.word, group)))
        return address

    def _connect_pixels(self, m, i, j, lane, loader, readout, cleared):
        """Connect a lane to its pixel of the loader, and its outputs to the readout."""
        pixels = loader.o.payload.pixels
        if self.config.memory == "dual":
            m.d.comb += [
                lane.loaded.depth.eq(pixels.depth[j]),
                lane.loaded.colour.eq(pixels.colour[j]),
            ]
        m.d.comb += readout.lanes[i][j].eq(lane.old)
        if self.config.flush_words == 2:
            m.d.comb += [
                lane.loaded.depth.eq(pixels.depth[j] | cleared),
                readout.odd[i][j].eq(lane.odd),
            ]

    def _touch(self, m, flush_scan, going):
        """Tell the flush scan which words the tile writes."""
        tile = self.i.payload
        m.d.comb += [
            flush_scan.words.eq(tile.words),
            flush_scan.group.eq(tile.group),
            flush_scan.reaching.eq(self.i.valid & ~tile.end),
        ]
        for i in range(SIDE):
            m.d.comb += [
                flush_scan.touch[i][0].eq(going & (tile.mask[i] & ~tile.next).any()),
                flush_scan.touch[i][1].eq(going & (tile.mask[i] & tile.next).any()),
            ]

    def _touch_loaded(self, m, flush_scan, load, service, grants):
        """Tell the flush scan which word is loaded."""
        m.d.comb += [
            flush_scan.load.eq(service.row & grants.loading.replicate(SIDE)),
            flush_scan.load_word.eq(load.word),
            # Rows of lanes without a tile take the address of the load.
            flush_scan.lone.eq(grants.lone),
        ]
        for i in range(SIDE):
            with m.If(flush_scan.lone[i]):
                m.d.comb += flush_scan.group[i].eq(load.line[2 : self.config.slot_bits])
