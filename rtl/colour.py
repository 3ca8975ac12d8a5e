"""Colour evaluation: the paper's equation 2, with its material table."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import ColouredLayout, ElementLayout
from .material_table import MaterialTable
from .tables import MaterialWriteLayout

__all__ = ["ColourUnit"]


class ColourUnit(wiring.Component):
    """Gives each element its colour: ``I = min((I0 + kd D + ks S) >> shift, largest)``.

    **Latency**: 2 cycles (table, products); the sum follows in the same cycle. **Throughput**: one
    element a cycle. A stage whose element waits lets those before it close up.

    With ``dither`` a channel keeps four fraction bits, ``min((I0 + kd D + ks S) >> shift - 4,
    16 largest + 15)``: adding a threshold of 0..15 and dropping them gives what adding it before
    the shift would, and 0..15 sixteenths above the largest channel are the largest still.

    Members
    -------
    i : In(stream of ElementLayout)
        Elements with D, S and a material. End tokens pass through.
    o : Out(stream of ColouredLayout)
        The same elements with a colour.
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
                "o": Out(stream.Signature(ColouredLayout(config))),
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

        valid = Signal(2)
        step = Signal(2)
        looked_up = Signal(ElementLayout(config), reset_less=True)
        multiplied = Signal(ElementLayout(config), reset_less=True)
        m.d.comb += [
            step[1].eq(~valid[1] | self.o.ready),
            step[0].eq(~valid[0] | step[1]),
            self.i.ready.eq(step[0]),
            self.o.valid.eq(valid[1]),
            table.enable.eq(step[0]),
            table.address.eq(self.i.payload.material),
        ]

        # With c bits of a coefficient and i of an intensity a product is at most
        #     (2^c - 1)(2^i - 1) = 2^(c+i) - 2^c - 2^i + 1           and fits c + i bits,
        # I0 has c + i + 1 bits, so that the first sum is at most
        #     2^(c+i+1) - 1 + 2^(c+i) - 2^c - 2^i + 1 < 3 2^(c+i)     and fits c + i + 2 bits,
        # and the whole is at most
        #     2^(c+i+1) - 1 + 2 (2^(c+i) - 2^c - 2^i + 1)
        #         = 2^(c+i+2) - 2 (2^c + 2^i) + 1 < 2^(c+i+2)         and fits them as well.
        # Nothing is negative, nothing wraps: a channel saturates where a bit above its own is set.
        product_bits = config.coefficient_bits + config.intensity_bits
        channels = []
        for channel, name in enumerate(("red", "green", "blue")):
            kd = config.coefficient(0, channel)
            ks = config.coefficient(1, channel)
            # I0 joins the first product, so that each adder has two inputs.
            diffuse = Signal(product_bits + 2, name=f"diffuse_{name}", reset_less=True)
            specular = Signal(product_bits, name=f"specular_{name}", reset_less=True)
            with m.If(step[1]):
                m.d.sync += [
                    diffuse.eq(
                        table.data[kd.lsb : kd.end] * looked_up.diffuse + self.ambient[channel]
                    ),
                    specular.eq(table.data[ks.lsb : ks.end] * looked_up.specular),
                ]
            total = Signal(config.ambient_bits + 1, name=f"sum_{name}")
            # With dithering a channel keeps the fraction that the thresholds are added to.
            shift = config.colour_shift - config.dither_bits
            level = Signal(len(total) - shift, name=f"level_{name}")
            m.d.comb += [
                total.eq(diffuse + specular),
                level.eq(total >> shift),
            ]
            bits = config.channel_bits + config.dither_bits
            largest = Const((1 << bits) - 1, bits)
            channels.append(Mux(level > largest, largest, level[:bits]))

        with m.If(step[0]):
            m.d.sync += [valid[0].eq(self.i.valid), looked_up.eq(self.i.payload)]
        with m.If(step[1]):
            m.d.sync += [valid[1].eq(valid[0]), multiplied.eq(looked_up)]
        m.d.comb += self.o.payload.colour.eq(Cat(channels))
        for name in ("mode", "scans", "x", "z", "top", "end"):
            m.d.comb += self.o.payload[name].eq(multiplied[name])
        return m
