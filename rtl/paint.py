"""What the banks draw in the cycles after a request: an element's pixels or a loaded word's."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from .format import BAYER, EngineConfig
from .layouts import PixelsLayout, PlaneLayout, WordLayout
from .planar_bank import PaintLayout

__all__ = ["Paint", "dithered", "paint_layout"]


def paint_layout(config: EngineConfig) -> data.Layout:
    """Return the layout of what a bank is given to draw."""
    return WordLayout(config) if config.colour_planes == 1 else PaintLayout(config)


def dithered(config: EngineConfig, shade, line: int, column: int) -> Cat:
    """Return a pixel's colour: an element's, with its threshold added and the fraction dropped."""
    if not config.dither:
        return shade
    width = config.channel_bits + config.dither_bits
    threshold = BAYER[line % 4][column % 4]
    channels = []
    for channel in range(3):
        value = shade[channel * width : (channel + 1) * width]
        fraction, level = value[: config.dither_bits], value[config.dither_bits :]
        # A choice of two, of which all pixels share both: an addition a pixel takes more.
        above = Mux(level == config.channel_max, level, level + 1)[: config.channel_bits]
        carry = fraction >= (1 << config.dither_bits) - threshold if threshold else Const(0, 1)
        channels.append(Mux(carry, above, level))
    return Cat(channels)


class Paint(wiring.Component):
    """Holds what was requested until the banks draw it, whatever bank that is.

    Banks serve lines by their residue modulo 4 and pixels by their column's, so with ``dither``
    each residue has its own colours; without, all banks are given the same.

    With further planes a word's parts come at two times (see :class:`PaintLayout`), and a loaded
    word's share a bus: nothing is drawn two cycles after a load, and a load waits where something
    was drawn or loaded two cycles before. As the planes keep a bank busy at the same time, this
    takes next to nothing.

    **Latency**: 2 cycles; with further planes 1, and 3 to these. **Throughput**: an element or a
    loaded word a cycle; with further planes no load two cycles after anything and nothing two
    cycles after a load.

    Members
    -------
    enable : In(1)
        Low: everything stands still.
    z, shade : In
        The element's depth and colour in the cycle of the request.
    load : In(raster_words)
        The request, if there is one, is for this word of the initial raster's beat, from left to
        right. It goes before the element.
    loaded : In(PixelsLayout)
        The initial raster's beat.
    drawing : In(1)
        Requests for the element are made in this cycle; not in the two after a load.
    may_load : Out(1)
        There is room for a loaded word.
    new : Out(1 or 4 x paint_layout)
        What the banks draw, by the residue of their lines.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "enable": In(1),
                "z": In(config.z.width),
                "shade": In(3 * (config.channel_bits + config.dither_bits)),
                "load": In(config.raster_words),
                "loaded": In(PixelsLayout(config, config.raster_pixels)),
                "drawing": In(1),
                "may_load": Out(1, init=1),
                "new": Out(data.ArrayLayout(paint_layout(config), 4 if config.dither else 1)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        if self.config.colour_planes == 1:
            self._whole(m)
        else:
            self._planes(m)
        return m

    def _colours(self, shade):
        """Return the element's colours by residue and pixel."""
        pixels = range(self.config.pixels_per_word)
        return [[dithered(self.config, shade, line, p) for p in pixels] for line in range(4)]

    def _whole(self, m):
        """Build the two registers of words that are drawn in one access."""
        config = self.config
        z, shade = (
            Signal.like(getattr(self, name), name=f"held_{name}", reset_less=True)
            for name in ("z", "shade")
        )
        words = [
            Signal(WordLayout(config), name=f"held_word_{n}", reset_less=True)
            for n in range(config.raster_words)
        ]
        new = Signal(self.new.shape(), reset_less=True)
        m.d.comb += self.new.eq(new)
        # All but one are zeros, which registers become for nothing; so an OR will do to join them.
        with m.If(self.enable):
            m.d.sync += [z.eq(self.z), shade.eq(self.shade)]
            with m.If(self.load.any()):
                m.d.sync += [z.eq(0), shade.eq(0)]
            for number, word in enumerate(words):
                m.d.sync += word.eq(self._word(number))
                with m.If(~self.load[number]):
                    m.d.sync += word.eq(0)
            for line, colours in zip(range(len(new)), self._colours(shade), strict=False):
                for pixel in range(config.pixels_per_word):
                    depth, colour = z, colours[pixel]
                    for word in words:
                        depth |= word.depth[pixel]
                        colour |= word.colour[pixel]
                    m.d.sync += [
                        new[line].depth[pixel].eq(depth),
                        new[line].colour[pixel].eq(colour),
                    ]

    def _word(self, number):
        """Return a word of the initial raster's beat."""
        first = number * self.config.pixels_per_word
        return Cat(
            pixels[first : first + self.config.pixels_per_word]
            for pixels in (self.loaded.depth, self.loaded.colour)
        )

    def _planes(self, m):
        """Build the registers and delays of words that are drawn in two accesses."""
        config = self.config
        drew, loaded = Signal(2), Signal(2)  # one cycle before, two cycles before
        load = Signal()
        m.d.comb += [
            self.may_load.eq(~drew[1] & ~loaded[1]),
            load.eq(self.load & self.may_load),
        ]
        plane = PlaneLayout(config)
        new = Signal(self.new.shape(), reset_less=True)
        m.d.comb += self.new.eq(new)
        word = Signal(data.ArrayLayout(plane, 2))  # what is to be loaded, early and late
        shade = Signal.like(self.shade)
        with m.If(load):
            for pixel in range(config.pixels_per_word):
                self._cut(m, word, pixel, self.loaded.depth[pixel], self.loaded.colour[pixel])
        with m.If(~self.load):
            m.d.comb += shade.eq(self.shade)
        # A plane that follows is on its way for two cycles longer.
        held = [Signal(plane, name=f"held_{n}", reset_less=True) for n in range(2)]
        with m.If(self.enable):
            m.d.sync += [
                drew.eq(Cat(self.drawing, drew)),
                loaded.eq(Cat(load, loaded)),
                held[0].eq(word[1]),
                held[1].eq(held[0]),
            ]
        for line, colours in zip(range(len(new)), self._colours(shade), strict=False):
            drawn = Signal(data.ArrayLayout(plane, 2), name=f"drawn_{line}")
            waiting = [Signal(plane, name=f"waiting_{line}_{n}", reset_less=True) for n in range(2)]
            for pixel in range(config.pixels_per_word):
                self._cut(m, drawn, pixel, Mux(self.load, 0, self.z), colours[pixel])
            with m.If(self.enable):
                m.d.sync += [
                    new[line].early.eq(drawn[0]),
                    waiting[0].eq(drawn[1]),
                    waiting[1].eq(waiting[0]),
                    new[line].late.eq(waiting[1]),
                    new[line].loaded.eq(word[0].as_value() | held[1].as_value()),
                ]
                for pixel in range(config.pixels_per_word):
                    m.d.sync += (
                        new[line].depth[pixel].eq(Mux(self.load, self.loaded.depth[pixel], self.z))
                    )

    def _cut(self, m, parts, pixel, depth, colour):
        """Cut a pixel into what is drawn early and what is drawn late."""
        bits = self.config.plane_bits
        early, late = parts
        m.d.comb += [
            early.depth[pixel].eq(depth),
            early.colour[pixel].eq(colour[:bits]),
            late.colour[pixel].eq(colour[bits : 2 * bits]),
        ]
        if self.config.colour_planes == 3:
            m.d.comb += late.depth[pixel].eq(colour[2 * bits :])
