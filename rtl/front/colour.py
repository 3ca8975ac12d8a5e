"""Colour evaluation: the paper's equation 2, with its material table."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import ElementLayout, GeometryLayout

from .material_table import MaterialTable
from .plane import plane_of
from .tables import MaterialWriteLayout

__all__ = ["ColourUnit"]


class ColourUnit(wiring.Component):
    """Computes each element's colour: ``I = min((I0 + kd D + ks S) >> shift, largest)``.

    The elements pass through the table's stage to ``o``. Their colours follow in stages that
    advance with ``o`` and with ``moves``.

    **Latency**: 1 cycle (table) to ``o``. Two more to ``shade`` (coefficients, products); in the
    blocks engine four more (coefficients, products, their sums, ``shade`` itself).
    **Throughput**: one element a cycle.

    Members
    -------
    i : In(stream of ElementLayout)
        Elements with D, S and a material. End tokens pass through.
    o : Out(stream of GeometryLayout)
        The same elements.
    moves : In(1)
        The element that was last taken from ``o`` advances to the window. In the blocks engine it
        advances by one of three stages.
    shade : Out(colour_bits)
        Colour of the element that last advanced into the last stage.
    ambient : In(3 x ambient_bits)
        I0 of red, green and blue; steady during a frame.
    material : In(MaterialWriteLayout)
        Write port of the table; not used while an element is inside.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(ElementLayout(config))),
                "o": Out(stream.Signature(GeometryLayout(config))),
                "moves": In(1),
                "shade": Out(config.colour_bits),
                "ambient": In(data.ArrayLayout(config.ambient_bits, 3)),
                "material": In(MaterialWriteLayout(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config

        m.submodules.table = table = MaterialTable(config)
        m.d.comb += table.write.eq(self.material)

        valid = Signal()
        step = Signal()
        looked_up = Signal(ElementLayout(config), reset_less=True)
        m.d.comb += [
            step.eq(~valid | self.o.ready),
            self.i.ready.eq(step),
            self.o.valid.eq(valid),
            table.enable.eq(step),
            table.address.eq(self.i.payload.material),
        ]
        for name in self.o.payload.shape().members:
            if name != "plane":
                m.d.comb += self.o.payload[name].eq(looked_up[name])
        if config.plane:
            m.d.comb += self.o.payload.plane.eq(plane_of(m, self.i.payload, step, config))

        # With c bits of a coefficient and i of an intensity a product is at most
        #     (2^c - 1)(2^i - 1) = 2^(c+i) - 2^c - 2^i + 1           and fits c + i bits,
        # I0 has c + i + 1 bits, and so the whole is at most
        #     2^(c+i+1) - 1 + 2 (2^(c+i) - 2^c - 2^i + 1)
        #         = 2^(c+i+2) - 2 (2^c + 2^i) + 1 < 2^(c+i+2)         and fits c + i + 2 bits.
        # Nothing is negative, nothing wraps: a channel saturates where a bit above its own is set.
        #
        # A register between block RAM and multiplier, because both are slow.
        coefficients = Signal.like(table.data, name="coefficients", reset_less=True)
        diffuse = Signal(config.intensity_bits, reset_less=True)
        specular = Signal(config.intensity_bits, reset_less=True)
        with m.If(self.o.ready):
            m.d.sync += [
                coefficients.eq(table.data),
                diffuse.eq(looked_up.diffuse),
                specular.eq(looked_up.specular),
            ]
        channels = []
        for channel, name in enumerate(("red", "green", "blue")):
            kd = config.coefficient(0, channel)
            ks = config.coefficient(1, channel)
            # In the blocks engine this is their sum, and the products have their own registers.
            products = Signal(config.ambient_bits, name=f"products_{name}", reset_less=True)
            both = [
                coefficients[kd.lsb : kd.end] * diffuse,
                coefficients[ks.lsb : ks.end] * specular,
            ]
            if config.draws_blocks:
                both = [
                    self._hold(m, product, f"{kind}_{name}")
                    for kind, product in zip(("diffuse", "specular"), both, strict=True)
                ]
            with m.If(self.moves):
                m.d.sync += products.eq(both[0] + both[1])
            total = Signal(config.ambient_bits + 1, name=f"sum_{name}")
            level = Signal(len(total) - config.colour_shift, name=f"level_{name}")
            m.d.comb += [
                # A stage after the multiplication, which is slow.
                total.eq(products + self.ambient[channel]),
                level.eq(total >> config.colour_shift),
            ]
            largest = Const(config.channel_max, config.channel_bits)
            channels.append(Mux(level > largest, largest, level[: config.channel_bits]))

        with m.If(step):
            m.d.sync += [valid.eq(self.i.valid), looked_up.eq(self.i.payload)]
        shade = Cat(channels)
        if config.draws_blocks:
            shade = self._hold(m, shade, "held_shade")
        m.d.comb += self.shade.eq(shade)
        return m

    def _hold(self, m, value, name):
        """Return a register of a value, which advances with the elements."""
        held = Signal(len(value), name=name, reset_less=True)
        with m.If(self.moves):
            m.d.sync += held.eq(value)
        return held
