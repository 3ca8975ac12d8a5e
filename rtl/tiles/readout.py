"""The readout of the tiles engine."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout, PlaceLayout, RasterLayout
from splatline.rtl.lib.mux import choose

__all__ = ["TileReadout"]


class TileReadout(wiring.Component):
    """Reads flushed words and forms raster beats.

    A word is on its lanes' outputs in the cycle after its request. The register on ``raster`` takes
    it from there. A word of background only is dropped: a dirty bit is for two words, and one of
    them may be clean. Pixels of background, and pixels right of the image, get colour 0.

    Stall: if ``raster`` does not take its word and a second one is on the lanes' outputs, the lanes
    and all stages before them stall. While ``raster`` is not ready, dropping a word takes a cycle.

    With ``flush_words`` 2 a request is for a pair of words. The even word comes as with one, and
    the odd one a cycle later from the lanes' other ports. It stays there until it is taken.

    **Latency**: 2 cycles from a request to ``raster``. **Throughput**: one word a cycle.

    Members
    -------
    flush : In(1)
        A word is requested in this cycle; only while ``running``, and never while ``busy``.
    place : In(PlaceLayout)
        Position of the word; of a pair the even one.
    lanes : In(4 x pixels_per_word x PixelLayout)
        The lanes' outputs, by residue of line and column.
    odd : In(4 x pixels_per_word x PixelLayout)
        With ``flush_words`` 2: the outputs of their other ports.
    last_column : In(x_bits)
        Width of the image less 1.
    end : In(1)
        Send the end beat once all requested words have left.
    raster : Out(stream of RasterLayout)
        The beats.
    running : Out(1)
        Low: the lanes and all requests stall.
    busy : Out(1)
        With ``flush_words`` 2: a pair was requested in the cycle before, stalls not counted. No
        other may be requested.
    finished : Out(1)
        High for one cycle: the register on ``raster`` takes the end beat.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        self.pairs = config.flush_words == 2
        row = data.ArrayLayout(PixelLayout(config), config.pixels_per_word)
        pairs = {"odd": In(data.ArrayLayout(row, 4)), "busy": Out(1)} if self.pairs else {}
        super().__init__(
            {
                "flush": In(1),
                "place": In(PlaceLayout(config)),
                "lanes": In(data.ArrayLayout(row, 4)),
                "last_column": In(config.x_bits),
                "end": In(1),
                "raster": Out(stream.Signature(RasterLayout(config))),
                "running": Out(1),
                "finished": Out(1),
                **pairs,
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        flushed = Signal()
        place = Signal(PlaceLayout(config), reset_less=True)
        emit_valid = Signal()
        emit = Signal(RasterLayout(config), reset_less=True)
        dropped = Signal()
        take = Signal()
        over = Signal()
        visible = Signal(config.pixels_per_word)
        leaves, word = flushed, place.word
        if self.pairs:
            odd = Signal()
            leaves, word = flushed | odd, place.word | odd
            m.d.comb += self.busy.eq(flushed)
            with m.If(self.running):
                m.d.sync += odd.eq(flushed)
        m.d.comb += [
            # Background is detected behind the register, because the path to it is long.
            self.raster.valid.eq(emit_valid & (visible.any() | emit.end)),
            self.raster.payload.eq(emit),
            # Not ~raster.valid, whose comparisons would lengthen the path through ``take``.
            take.eq(~emit_valid | self.raster.ready | dropped),
            self.running.eq(~(leaves & ~take)),
            over.eq(self.end & ~leaves),
            self.finished.eq(over & take),
        ]
        m.d.sync += dropped.eq(emit_valid & ~visible.any() & ~emit.end & ~take)
        with m.If(self.running):
            m.d.sync += [flushed.eq(self.flush), place.eq(self.place)]
            if self.pairs:
                with m.If(flushed):  # of both words
                    m.d.sync += place.eq(place)
        with m.If(take):
            m.d.sync += [
                emit_valid.eq(leaves | over),
                emit.word.eq(word),
                emit.line.eq(place.line),
                emit.end.eq(over),
            ]

        background = config.background_depth
        line = place.line[:2]
        last_pixel = self.last_column[: config.pixel_bits]
        last_word = self.last_column[config.pixel_bits :]
        for column in range(config.pixels_per_word):
            rows = [self.lanes[row][column].as_value() for row in range(4)]
            pixel = Signal(PixelLayout(config), name=f"pixel_{column}")
            if self.pairs:
                rows += [self.odd[row][column].as_value() for row in range(4)]
                m.d.comb += pixel.as_value().eq(choose(m, rows, Cat(line, odd)))
            else:
                m.d.comb += pixel.as_value().eq(
                    Mux(line[1], Mux(line[0], rows[3], rows[2]), Mux(line[0], rows[1], rows[0]))
                )
            with m.If(take):
                m.d.sync += [
                    emit.pixels.depth[column].eq(pixel.depth),
                    emit.pixels.colour[column].eq(pixel.colour),
                ]
            # Elements are clipped by whole words, so the last word may have pixels outside.
            depth, colour = emit.pixels.depth[column], emit.pixels.colour[column]
            outside = (emit.word == last_word) & (column > last_pixel)
            m.d.comb += [
                visible[column].eq((depth != background) & ~outside),
                self.raster.payload.pixels.depth[column].eq(
                    depth | outside.replicate(config.depth_bits)
                ),
                self.raster.payload.pixels.colour[column].eq(Mux(visible[column], colour, 0)),
            ]
        return m
