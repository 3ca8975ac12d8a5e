"""The way out of the lanes: pixels of a word, which leave together, become a raster's beat."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout, PlaceLayout, RasterLayout
from splatline.rtl.lib.mux import choose

__all__ = ["TileReadout"]


class TileReadout(wiring.Component):
    """Picks each flushed word from its lanes and offers it on ``raster``.

    A word stands on its lanes' outputs in the cycle after its request and is taken from there into
    the register on the port. A word of background only is dropped: it was marked as one of a pair.
    The colour of a pixel that is background, or that lies right of the image, is made 0.

    A word that ``raster`` does not take stops the stages behind it, and the lanes, once a second
    word stands before the port. While ``raster`` is not ready, dropping a word takes a cycle.

    With ``flush_words`` 2 a request stands for a pair of words: the even one comes as ever, and the
    odd one a cycle later from the lanes' other ports, where it stays until it is taken.

    **Latency**: 2 cycles from a request to ``raster``. **Throughput**: one word a cycle.

    Members
    -------
    flush : In(1)
        A word is requested in this cycle; only while ``running``, and not while ``busy``.
    place : In(PlaceLayout)
        Which word that is; of a pair the even one.
    lanes : In(4 x pixels_per_word x PixelLayout)
        The lanes' outputs, by residue of line and column.
    odd : In(4 x pixels_per_word x PixelLayout)
        With ``flush_words`` 2: their other ones.
    last_column : In(x_bits)
        Width of the image less 1.
    end : In(1)
        The frame is over once no word is on its way; leaves as the end beat.
    raster : Out(stream of RasterLayout)
        The beats.
    running : Out(1)
        Low: the lanes and all requests stand still.
    busy : Out(1)
        With ``flush_words`` 2: a pair was requested in the cycle before, but for those in which all
        stood still. No other may be.
    finished : Out(1)
        High for one cycle: the end beat is taken into the register on the port.
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
        take, over = Signal(), Signal()
        visible = Signal(config.pixels_per_word)
        leaves, word = flushed, place.word
        if self.pairs:
            odd = Signal()
            leaves, word = flushed | odd, place.word | odd
            m.d.comb += self.busy.eq(flushed)
            with m.If(self.running):
                m.d.sync += odd.eq(flushed)
        m.d.comb += [
            # What is background is known behind the register: the way to it is long enough.
            self.raster.valid.eq(emit_valid & (visible.any() | emit.end)),
            self.raster.payload.eq(emit),
            # Not ~raster.valid: what hangs on ``take`` would wait for the comparisons in it.
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
            # Elements are clipped by whole words; the rest of the last word stays inside.
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
