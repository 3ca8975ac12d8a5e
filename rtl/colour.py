"""Colour evaluation: the paper's equation 2, with its material table."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, memory, stream, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import ColouredLayout, ElementLayout
from .tables import MaterialWriteLayout

__all__ = ["ColourUnit"]


class ColourUnit(wiring.Component):
    """Gives each element its colour: ``I = min((I0 + kd D + ks S) >> shift, largest)``.

    **Latency**: 3 cycles (table, products, sum). **Throughput**: one element a cycle. The whole
    pipeline stops while its output waits.

    The sum of 14 + 1 bits in ``paper`` cannot overflow: see ``docs/contract.md``, "Colour".

    Members
    -------
    i : In(stream of ElementLayout)
        Elements with D, S and a material. End tokens pass through.
    o : Out(stream of ColouredLayout)
        The same elements with a colour.
    ambient : In(3 x ambient_bits)
        I0 of red, green and blue; steady during a frame.
    material : In(MaterialWriteLayout)
        Write port of the table.
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

        m.submodules.table = table = memory.Memory(
            shape=6 * config.coefficient_bits,
            depth=1 << config.material_bits,
            init=[],
            attrs={"ram_style": "block"},
        )
        write = table.write_port()
        read = table.read_port()
        m.d.comb += [
            write.en.eq(self.material.enable),
            write.addr.eq(self.material.address),
            write.data.eq(self.material.data),
        ]

        step = Signal()
        valid = Signal(3)
        looked_up = Signal(ElementLayout(config), reset_less=True)
        multiplied = Signal(ElementLayout(config), reset_less=True)
        coloured = Signal(ColouredLayout(config), reset_less=True)
        m.d.comb += [
            step.eq(~valid[2] | self.o.ready),
            self.i.ready.eq(step),
            self.o.valid.eq(valid[2]),
            self.o.payload.eq(coloured),
            read.en.eq(step),
            read.addr.eq(self.i.payload.material),
        ]

        product_bits = config.coefficient_bits + config.intensity_bits
        channels = []
        for channel, name in enumerate(("red", "green", "blue")):
            kd = config.coefficient(0, channel)
            ks = config.coefficient(1, channel)
            # I0 joins the first product, so that each adder has two inputs.
            diffuse = Signal(product_bits + 2, name=f"diffuse_{name}", reset_less=True)
            specular = Signal(product_bits, name=f"specular_{name}", reset_less=True)
            with m.If(step):
                m.d.sync += [
                    diffuse.eq(
                        read.data[kd.lsb : kd.end] * looked_up.diffuse + self.ambient[channel]
                    ),
                    specular.eq(read.data[ks.lsb : ks.end] * looked_up.specular),
                ]
            total = Signal(config.ambient_bits + 1, name=f"sum_{name}")
            level = Signal(len(total) - config.colour_shift, name=f"level_{name}")
            m.d.comb += [
                total.eq(diffuse + specular),
                level.eq(total >> config.colour_shift),
            ]
            largest = Const(config.channel_max, config.channel_bits)
            channels.append(Mux(level > config.channel_max, largest, level[: len(largest)]))

        with m.If(step):
            m.d.sync += [
                valid.eq(Cat(self.i.valid, valid[:2])),
                looked_up.eq(self.i.payload),
                multiplied.eq(looked_up),
                coloured.colour.eq(Cat(channels)),
            ]
            for name in ("mode", "scans", "x", "z", "top", "end"):
                m.d.sync += coloured[name].eq(multiplied[name])
        return m
