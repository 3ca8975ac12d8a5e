"""A bank whose colours are cut into planes that fill the unused halves of its block RAMs."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from .bank import BankRequestLayout
from .bank_layout import bank_address_bits
from .format import EngineConfig
from .layouts import PlaneLayout

__all__ = ["PaintLayout", "PlanarBank"]


class PaintLayout(data.StructLayout):
    """What all banks draw, each part at its own time after the request at t.

    ``early``: an element's depth and plane 0, at t + 1. ``late``: its further planes, at t + 3.
    """

    def __init__(self, config: EngineConfig):
        plane = PlaneLayout(config)
        super().__init__({"early": plane, "late": plane})


class LateLayout(data.StructLayout):
    """A word on its way through the accesses to its further planes.

    ``read``: the planes are read, to draw into them or to flush them. ``write``: and written, in
    the pixels of ``mask``.
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "read": 1,
                "write": 1,
                "mask": config.pixels_per_word,
                "address": bank_address_bits(config),
            }
        )


class PlanarBank(wiring.Component):
    """Does what :class:`Bank` does, and then the further planes of words that need it.

    A word requested at t is compared and merged at t + 1, as in :class:`Bank`. If a pixel passed,
    or the word is cleared and was not all background, its further planes are read at t + 2 from the
    upper halves of the block RAMs, which takes the read ports: ``busy`` is high in that cycle.
    At t + 3 they stand on ``old`` and are merged; no request was taken at t + 2, so the write ports
    are free.

    Clearing leaves background in the depths alone. **The colours under it are stale**, and whoever
    reads the word has to put 0 in their place; a pixel that is drawn later gets all of its planes.
    For the same reason the clears after a reset need not heed ``busy``: if nobody wants what
    the planes held, nothing is lost.

    A word is loaded through the ports that read, as in :class:`Bank`: its depths and plane 0, and
    in a second request its further planes.

    **Latency**: 1 cycle to ``old``, 3 to its further planes; 2 and 4 to the memory.
    **Throughput**: one request a cycle, less one cycle for each that draws a pixel or clears one,
    two cycles after it. Not the same word in two neighbouring cycles.

    Members
    -------
    enable : In(1)
        Low: everything stands still, and ``request`` is not taken.
    request : In(BankRequestLayout)
        What to do. Never the word that is being written now; neither ``draw`` nor ``load`` is
        raised while ``busy`` is high.
    new : In(PaintLayout)
        Depths and colours to draw.
    loaded : In(PlaneLayout)
        What to load, in the cycle of the request.
    busy : Out(1)
        The memories are being read for the request of two cycles before.
    old : Out(PlaneLayout)
        The word of the request one cycle before, or the further planes of the one three before.
    drawn : Out(1)
        Pixels were requested to be drawn one cycle before, or loaded, into the word at
        ``drawn_address``.
    drawn_address : Out(bank_address_bits)
        Which word that is.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "enable": In(1),
                "request": In(BankRequestLayout(config)),
                "new": In(PaintLayout(config)),
                "loaded": In(PlaneLayout(config)),
                "busy": Out(1),
                "old": Out(PlaneLayout(config)),
                "drawn": Out(1),
                "drawn_address": Out(bank_address_bits(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        pixels = config.pixels_per_word

        taken = Signal(BankRequestLayout(config))
        reading = Signal(LateLayout(config))
        writing = Signal(LateLayout(config))
        passes = Signal(pixels)
        drawn = Signal()
        given_up = Signal()
        old_depths = Cat(depth[: config.depth_bits] for depth in self.old.depth)
        m.d.comb += [
            self.drawn.eq(taken.draw | taken.load),
            self.drawn_address.eq(taken.address),
            drawn.eq(taken.draw & passes.any()),
            given_up.eq(taken.clear & ~old_depths.all()),
        ]
        with m.If(self.enable):
            m.d.sync += [
                taken.eq(self.request),
                reading.read.eq(given_up | drawn),
                reading.write.eq(drawn),
                reading.mask.eq(passes),
                reading.address.eq(taken.address),
                writing.eq(reading),
            ]
        for pixel in range(pixels):
            m.d.comb += passes[pixel].eq(
                # The mask rides on the comparison's carry chain, which has a bit to spare.
                Cat(self.new.early.depth[pixel][: config.depth_bits], 1)
                < Cat(self.old.depth[pixel][: config.depth_bits], taken.mask[pixel])
            )
        m.d.comb += self.busy.eq(reading.read)

        # Where the late accesses go, of which there are none in the depths of two planes.
        late = {"depth": config.colour_planes == 3, "colour": True}
        merged = Signal(PlaneLayout(config))
        for name in ("depth", "colour"):
            m.submodules[f"{name}_ram"] = ram = memory.Memory(
                shape=len(merged[name].as_value()),
                depth=1 << bank_address_bits(config) + late[name],
                init=[],
                # Nobody counts on a word that is read while it is written.
                attrs={"ram_style": "block", "no_rw_check": 1},
            )
            read_port, load_port, write_port = ram.read_port(), ram.write_port(), ram.write_port()
            further = self.request.load & self.request.further
            late_read = Signal(name=f"late_{name}_read")
            late_write = Signal(name=f"late_{name}_write")
            m.d.comb += [
                late_read.eq(reading.read & late[name]),
                late_write.eq(writing.write & late[name]),
                read_port.en.eq(self.enable),
                read_port.addr.eq(
                    Cat(
                        Mux(late_read, reading.address, self.request.address),
                        late_read | (further & late[name]),
                    )
                ),
                # Of the same address and enable, so that the two are one port of the block RAM.
                load_port.addr.eq(read_port.addr),
                load_port.en.eq(self.enable & self.request.load & (~further | late[name])),
                load_port.data.eq(self.loaded[name]),
                self.old[name].as_value().eq(read_port.data),
                # Written every cycle while standing still, the word comes out the same each time.
                write_port.en.eq(taken.draw | taken.clear | late_write),
                write_port.addr.eq(
                    Cat(Mux(late_write, writing.address, taken.address), late_write)
                ),
                write_port.data.eq(merged[name]),
            ]

        selected = Signal(pixels)
        m.d.comb += selected.eq(
            Mux(writing.write, writing.mask, passes | taken.clear.replicate(pixels))
        )
        for pixel in range(pixels):
            early, after = self.new.early, self.new.late
            colour = Signal(config.plane_bits, name=f"colour_{pixel}")
            m.d.comb += [
                colour.eq(Mux(writing.write, after.colour[pixel], early.colour[pixel])),
                merged.colour[pixel].eq(Mux(selected[pixel], colour, self.old.colour[pixel])),
            ]
            if not late["depth"]:
                m.d.comb += merged.depth[pixel].eq(
                    Mux(passes[pixel], early.depth[pixel], self.old.depth[pixel])
                    | taken.clear.replicate(config.depth_bits)
                )
                continue
            depth = Signal.like(self.old.depth[pixel], name=f"depth_{pixel}")
            m.d.comb += [
                depth.eq(
                    Mux(
                        writing.write,
                        after.depth[pixel],
                        early.depth[pixel] | taken.clear.replicate(len(depth)),
                    )
                ),
                merged.depth[pixel].eq(Mux(selected[pixel], depth, self.old.depth[pixel])),
            ]
        return m
