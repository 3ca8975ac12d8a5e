"""The way out: what the banks give up becomes a beat of the raster."""

from functools import reduce
from operator import and_, or_

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import residue_bits, turned
from .choose import choose
from .format import EngineConfig
from .layouts import FlushLayout, PlaneLayout, RasterLayout

__all__ = ["Emitter"]


class Emitter(wiring.Component):
    """Takes each flushed word from its bank and offers it on ``raster``.

    A word stands on its bank's output two cycles after its request, while all other banks give
    background; or one cycle after it if it has further planes, among whatever others have. From
    there it is taken into the register on the port. A beat of background only is dropped: what was
    drawn there did not pass the depth test or lies outside the image, or it shares a mark. Where
    beats have two words, one that was not requested is background.

    Where colours have further planes, they come out two cycles after plane 0, which waits for them
    in two registers; then a pixel that is background is given colour 0, as its planes are stale.
    Both come through one multiplexer, so no word may be requested two cycles after one that is not
    all background.

    A word that ``raster`` does not take stops the stages behind it, and the banks, once a second
    word stands in the last stage before the port.

    **Latency**: 3 cycles from a request to ``raster``, with further planes 4. **Throughput**: one
    beat a cycle; with further planes two in four, but all that are background.

    Members
    -------
    flush : In(1)
        ``request`` is made in this cycle; only while ``ready`` and ``running``.
    request : In(FlushLayout)
        Which words leave: one, or both of a beat of two.
    ready : Out(1)
        A word may be requested.
    words : In(banks x PlaneLayout)
        The banks' outputs: what leaves, or with further planes what was read.
    last_column : In(x_bits)
        Width of the image less 1.
    end : In(1)
        The frame is over once ``empty``; leaves as the end beat.
    raster : Out(stream of RasterLayout)
        The beats.
    running : Out(1)
        Low: the banks and all requests stand still.
    empty : Out(1)
        No word is between a bank and the port.
    finished : Out(1)
        High for one cycle: the end beat is taken into the register on the port.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "flush": In(1),
                "request": In(FlushLayout(config)),
                "ready": Out(1, init=1),
                "words": In(data.ArrayLayout(PlaneLayout(config), config.banks)),
                "last_column": In(config.x_bits),
                "end": In(1),
                "raster": Out(stream.Signature(RasterLayout(config))),
                "running": Out(1),
                "empty": Out(1),
                "finished": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config

        # The stages from a bank to the port, and the port.
        stages = 2 if config.colour_planes == 1 else 3
        valid = Signal(stages)
        places = [
            Signal(FlushLayout(config), name=f"place_{n}", reset_less=True) for n in range(stages)
        ]
        emit_valid = Signal()
        emit = Signal(RasterLayout(config), reset_less=True)
        take = Signal()
        over = Signal()
        m.d.comb += [
            self.raster.payload.eq(emit),
            self.running.eq(~(valid[-1] & ~take)),
            self.empty.eq(~valid.any()),
            over.eq(self.end & self.empty),
            self.finished.eq(over & take),
        ]
        with m.If(self.running):
            m.d.sync += valid.eq(Cat(self.flush, valid))
            for earlier, place in zip([self.request, *places], places, strict=False):
                m.d.sync += place.eq(earlier)

        if config.colour_planes == 1:
            pixels, shown = self._inside(places[-1], self._words(m, places[-1])), 1
            # What is background is known behind the register: the way to it is long enough.
            visible = Signal()
            blank = Signal()  # it was not visible in the cycle before, and still stands there
            m.d.comb += [
                visible.eq(emit.end | ~Cat(depth.all() for depth in emit.pixels.depth).all()),
                self.raster.valid.eq(emit_valid & visible),
                take.eq(~emit_valid | self.raster.ready | blank),
            ]
            m.d.sync += blank.eq(emit_valid & ~visible & ~take)
        else:
            pixels, drawn, shown = self._planes(m, places)
            m.d.comb += [
                self.ready.eq(~(valid[1] & drawn)),
                self.raster.valid.eq(emit_valid),
                take.eq(~emit_valid | self.raster.ready),
            ]

        with m.If(take):
            m.d.sync += [
                emit_valid.eq((valid[-1] & shown) | over),
                emit.word.eq(self._number(places[-1])),
                emit.line.eq(places[-1].line),
                emit.end.eq(over),
            ]
            for pixel, (depth, colour) in enumerate(pixels):
                m.d.sync += [
                    emit.pixels.depth[pixel].eq(depth),
                    emit.pixels.colour[pixel].eq(colour),
                ]
        return m

    def _number(self, place):
        """Return the number of a beat in its line."""
        if self.config.raster_words == 2:
            return place.pair
        return Cat(place.halves[1] ^ turned(self.config, place.line), place.pair)

    def _bank(self, place):
        """Return the bank of a beat of one word."""
        return Cat(place.line[: residue_bits(self.config)], place.halves[1])

    def _words(self, m, place):
        """Return a beat's words from left to right; background where one was not requested."""
        banks, half = self.config.banks, self.config.banks // 2
        if self.config.raster_words == 1:
            return [self._together(m, "word", range(banks))]
        lower = self._together(m, "lower", range(half))
        upper = self._together(m, "upper", range(half, banks))
        right_first = turned(self.config, place.line)
        left, right = (Signal.like(lower, name=name) for name in ("left", "right"))
        m.d.comb += [
            left.eq(Mux(right_first, upper, lower)),
            right.eq(Mux(right_first, lower, upper)),
        ]
        return [left, right]

    def _together(self, m, name, banks):
        """Return what one of some banks gives up: all others give background, ones and zeros."""
        word = Signal(PlaneLayout(self.config), name=name)
        m.d.comb += [
            word.depth.eq(reduce(and_, (self.words[bank].depth.as_value() for bank in banks))),
            word.colour.eq(reduce(or_, (self.words[bank].colour.as_value() for bank in banks))),
        ]
        return word

    def _inside(self, place, words):
        """Return a beat's depths and colours, with background for what lies outside the image.

        Elements are clipped by whole words.
        """
        config = self.config
        bits = config.raster_pixels.bit_length() - 1
        is_last = self._number(place) == self.last_column[bits:]
        pixels = []
        for pixel in range(config.raster_pixels):
            number, place_in_word = divmod(pixel, config.pixels_per_word)
            word = words[number]
            outside = is_last & (pixel > self.last_column[:bits])
            depth = word.depth[place_in_word][: config.depth_bits]
            pixels.append(
                (
                    Mux(outside, config.background_depth, depth),
                    Mux(outside, 0, word.colour[place_in_word]),
                )
            )
        return pixels

    def _planes(self, m, places):
        """Build the stages in which plane 0 waits.

        Return the depths and whole colours, and of which words some pixel is not background: the
        one that needs its planes next, and the one before the port.
        """
        config = self.config
        chosen = Signal(range(config.banks), reset_less=True)
        word = Signal(PlaneLayout(config))
        m.d.comb += word.eq(choose(m, self.words, chosen))
        before = Signal.like(chosen)  # the bank chosen one cycle ago
        pixel = data.StructLayout(
            {"depth": config.depth_bits, "colour": config.plane_bits, "background": 1}
        )
        row = data.ArrayLayout(pixel, config.pixels_per_word)
        caught = Signal(row, reset_less=True)
        waiting = Signal(row, reset_less=True)
        with m.If(self.running):
            m.d.sync += [
                # A bank that gave plane 0 is chosen again two cycles later for the planes.
                before.eq(chosen),
                chosen.eq(Mux(self.flush, self._bank(self.request), before)),
                waiting.eq(caught),
            ]
            for number, (depth, colour) in enumerate(self._inside(places[0], [word])):
                m.d.sync += [
                    caught[number].depth.eq(depth),
                    caught[number].colour.eq(colour),
                    waiting[number].background.eq(caught[number].depth.all()),
                ]
        drawn = ~Cat(held.depth.all() for held in caught).all()
        pixels = []
        for number, held in enumerate(waiting):
            colour = Cat(held.colour, word.colour[number])
            if config.colour_planes == 3:
                colour = Cat(colour, word.depth[number][: config.plane_bits])
            pixels.append((held.depth, Mux(held.background, 0, colour)))
        return pixels, drawn, ~Cat(held.background for held in waiting).all()
