"""What the banks draw in the cycles after a request: an element's pixels."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from .format import BAYER, EngineConfig
from .layouts import PlaneLayout, WordLayout
from .planar_bank import PaintLayout

__all__ = ["Paint", "cut", "dithered", "paint_layout"]


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


def cut(config: EngineConfig, parts, pixel: int, depth, colour) -> list:
    """Return the statements that cut a pixel into its early and its late part (PlaneLayouts)."""
    bits = config.plane_bits
    early, late = parts
    statements = [
        early.depth[pixel].eq(depth),
        early.colour[pixel].eq(colour[:bits]),
        late.colour[pixel].eq(colour[bits : 2 * bits]),
    ]
    if config.colour_planes == 3:
        statements.append(late.depth[pixel].eq(colour[2 * bits :]))
    return statements


class Paint(wiring.Component):
    """Holds what was requested until the banks draw it, whatever bank that is.

    Banks serve lines by their residue modulo 4 and pixels by their column's, so with ``dither``
    each residue has its own colours; without, all banks are given the same. With further planes a
    word's parts come at two times, see :class:`PaintLayout`.

    **Latency**: 1 cycle, 3 to further planes. **Throughput**: an element a cycle.

    Members
    -------
    enable : In(1)
        Low: everything stands still.
    z, shade : In
        The element's depth and colour in the cycle of the request.
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
                "new": Out(data.ArrayLayout(paint_layout(config), 4 if config.dither else 1)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        new = Signal(self.new.shape(), reset_less=True)
        m.d.comb += self.new.eq(new)
        if self.config.colour_planes == 1:
            self._whole(m, new)
        else:
            self._planes(m, new)
        return m

    def _colours(self, shade):
        """Return the element's colours by residue and pixel."""
        pixels = range(self.config.pixels_per_word)
        return [[dithered(self.config, shade, line, p) for p in pixels] for line in range(4)]

    def _whole(self, m, new):
        """Build the register of words that are drawn in one access."""
        with m.If(self.enable):
            for line, colours in zip(range(len(new)), self._colours(self.shade), strict=False):
                for pixel, colour in enumerate(colours):
                    m.d.sync += [
                        new[line].depth[pixel].eq(self.z),
                        new[line].colour[pixel].eq(colour),
                    ]

    def _planes(self, m, new):
        """Build the registers and delays of words that are drawn in two accesses."""
        plane = PlaneLayout(self.config)
        for line, colours in zip(range(len(new)), self._colours(self.shade), strict=False):
            drawn = Signal(data.ArrayLayout(plane, 2), name=f"drawn_{line}")
            # A plane that follows is on its way for two cycles longer.
            waiting = [Signal(plane, name=f"waiting_{line}_{n}", reset_less=True) for n in range(2)]
            for pixel, colour in enumerate(colours):
                m.d.comb += cut(self.config, drawn, pixel, self.z, colour)
            with m.If(self.enable):
                m.d.sync += [
                    new[line].early.eq(drawn[0]),
                    waiting[0].eq(drawn[1]),
                    waiting[1].eq(waiting[0]),
                    new[line].late.eq(waiting[1]),
                ]
