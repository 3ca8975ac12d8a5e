"""The way out of rows of lanes: beats wait in a queue, so that nothing else stands still."""

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
"""Beats of the queue. As many block RAMs hold up to 512: their width decides how many they are."""


class BlockReadout(wiring.Component):
    """Takes each flushed beat from its row of lanes and offers it on ``raster``.

    A beat stands on its row's output three cycles after it was asked for, while all other rows give
    background; from there it goes into a queue. ``room`` says that this was not half full a cycle
    before: so it has a place for all that is on its way, the lanes go on whatever ``raster`` does,
    and no way leads from there to them. A beat of background only is dropped behind the queue: what
    was drawn there did not pass the depth test or lies outside the image.

    **Latency**: 6 cycles from a request to ``raster``. **Throughput**: one beat a cycle; while
    ``raster`` is not ready, dropping one takes two.

    Members
    -------
    flush : In(1)
        A beat is asked for in this cycle; only with ``room``.
    place : In(PlaceLayout)
        Its even word.
    rows : In(8 x BeatWordsLayout)
        The rows' outputs.
    end : In(1)
        The frame is over, and no beat is asked for until ``finished``.
    raster : Out(stream of RasterLayout)
        The beats, and the end beat.
    room : Out(1)
        A beat may be asked for.
    finished : Out(1)
        High for one cycle: the end beat goes into the queue, behind all others.
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

        # Its stages: the request, the pixels that were read, the row's output.
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

        # What is background is known behind the queue's register: the way to it is long enough.
        out, raster = queue.o, self.raster
        visible = Signal()
        blank = Signal()  # it was not visible in the cycle before, and still stands there
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
        """Join the rows: all but the one that gives a beat up give background, ones and zeros."""
        for pixel in range(self.config.raster_pixels):
            number, column = divmod(pixel, self.config.pixels_per_word)
            words = [getattr(row, HALVES[number]) for row in self.rows]
            depths = zip(*(word.depth[column] for word in words), strict=True)
            colours = zip(*(word.colour[column] for word in words), strict=True)
            m.d.comb += [
                beat.pixels.depth[pixel].eq(Cat(map(all_of, depths))),
                beat.pixels.colour[pixel].eq(Cat(map(any_of, colours))),
            ]
