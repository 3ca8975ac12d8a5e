"""The readout of the blocks engine, with a FIFO so that no stage stalls."""

from itertools import pairwise

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, EngineConfig
from splatline.rtl.layouts import PlaceLayout, RasterLayout
from splatline.rtl.lib.fifo import Fifo
from splatline.rtl.lib.mux import all_of, any_of

from .lane_row import HALVES, BeatWordsLayout

__all__ = ["BlockReadout"]

DEPTH = 512
"""Beats of the FIFO. Fewer would not save block RAMs: a block RAM has 512 words."""


class BlockReadout(wiring.Component):
    """Reads flushed beats and puts them into a FIFO on ``raster``.

    A beat is on its row's output three cycles after its request, while all other rows give
    background. It goes into the FIFO from there. ``room``: the FIFO was less than half full a cycle
    before, so it has room for all requested beats. The lanes therefore never stall, and no path
    leads from ``raster`` to them. A beat of background only is dropped behind the FIFO: none of its
    pixels passed the depth test in the image.

    **Latency**: 6 cycles from a request to ``raster``. **Throughput**: one beat a cycle. While
    ``raster`` is not ready, dropping a beat takes two.

    Members
    -------
    flush : In(1)
        A beat is requested in this cycle; only with ``room``.
    place : In(PlaceLayout)
        Position of its even word.
    rows : In(8 x BeatWordsLayout)
        The rows' outputs.
    end : In(1)
        Send the end beat. No beat is requested until ``finished``.
    raster : Out(stream of RasterLayout)
        The beats, and the end beat.
    room : Out(1)
        A beat may be requested.
    finished : Out(1)
        High for one cycle: the end beat goes into the FIFO, behind all others.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "flush": In(1),
                "place": In(PlaceLayout(config)),
                "rows": In(data.ArrayLayout(BeatWordsLayout(config), BLOCK)),
                "end": In(1),
                "raster": Out(stream.Signature(RasterLayout(config))),
                "room": Out(1, init=1),
                "finished": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        m.submodules.queue = queue = Fifo(config, DEPTH)

        # A beat's stages: the request, the pixels that were read, the row's output.
        valid = Signal(3)
        places = [Signal(PlaceLayout(config), name=f"place_{n}", reset_less=True) for n in range(3)]
        m.d.sync += valid.eq(Cat(self.flush, valid))
        for before, after in pairwise([self.place, *places]):
            m.d.sync += after.eq(before)
        place, beat = places[-1], queue.i.payload
        m.d.comb += [
            self.finished.eq(self.end & self.room & ~valid.any()),
            queue.i.valid.eq(valid[-1] | self.finished),
            beat.word.eq(place.word[1:]),
            beat.line.eq(place.line),
            beat.end.eq(self.finished),
        ]
        self._join(m, beat)

        # Background is detected behind the FIFO's register, because the path to it is long.
        out, raster = queue.o, self.raster
        visible = Signal()
        blank = Signal()  # the offered beat was not visible in the cycle before
        m.d.comb += [
            visible.eq(out.payload.end | ~Cat(d.all() for d in out.payload.pixels.depth).all()),
            raster.valid.eq(out.valid & visible),
            raster.payload.eq(out.payload),
            out.ready.eq(raster.ready | blank),
        ]
        m.d.sync += blank.eq(out.valid & ~visible & ~out.ready)
        m.d.sync += self.room.eq(queue.level < DEPTH // 2)
        return m

    def _join(self, m, beat):
        """Join the rows by gates: rows that flush nothing give background, all ones and zeros."""
        for pixel in range(self.config.raster_pixels):
            number, column = divmod(pixel, self.config.pixels_per_word)
            words = [getattr(row, HALVES[number]) for row in self.rows]
            depths = zip(*(word.depth[column] for word in words), strict=True)
            colours = zip(*(word.colour[column] for word in words), strict=True)
            m.d.comb += [
                beat.pixels.depth[pixel].eq(Cat(map(all_of, depths))),
                beat.pixels.colour[pixel].eq(Cat(map(any_of, colours))),
            ]
