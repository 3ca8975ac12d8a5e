"""A bank of the window: one block RAM of depth, one of colour, and the writer between them."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import bank_address_bits
from .format import EngineConfig
from .layouts import WordLayout

__all__ = ["Bank", "BankRequestLayout"]


class BankRequestLayout(data.StructLayout):
    """What a bank is asked to do in a cycle.

    ``draw``: depth-test the pixels of ``mask`` of the word at ``address``. ``clear``: read that
    word and leave background in it. ``load``: copy a word there, whatever it is; with further
    planes, in two requests, the second one for ``further`` planes. At most one of the three.
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "draw": 1,
                "clear": 1,
                "load": 1,
                "further": 1,
                "mask": config.pixels_per_word,
                "address": bank_address_bits(config),
            }
        )


class Bank(wiring.Component):
    """Reads a word, tests and merges its pixels, and writes it back.

    The block RAM has one read and one write port and no byte enables, so a word is always written
    whole. It is read in the cycle of the request, and in the one after it is compared and merged
    with ``new`` and written at that cycle's end. A request for a word in the cycle after one of the
    same word would read stale pixels, and is never made.

    What is cleared is read into a register, which has background otherwise. So what leaves the
    window is what all banks have there together, and is not chosen from them.

    A word is loaded through the port that reads, which has no other use for that cycle: so it takes
    no multiplexer, and the other port may write at the same time, but not the same word.

    **Latency**: 2 cycles to ``leaving`` and to the memory, 1 for a load. **Throughput**: one
    request a cycle, but the same word in every second cycle at most.

    Members
    -------
    enable : In(1)
        Low: everything stands still, and ``request`` is not taken.
    request : In(BankRequestLayout)
        What to do. Not the word of the request before, if that draws or clears.
    new : In(WordLayout)
        Depth and colour to draw, one a pixel, in the cycle after the request.
    loaded : In(WordLayout)
        The word to load, in the cycle of the request.
    leaving : Out(WordLayout)
        The word that was requested to be cleared two cycles before, as it was, else background.
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
                "new": In(WordLayout(config)),
                "loaded": In(WordLayout(config)),
                "leaving": Out(WordLayout(config)),
                "drawn": Out(1),
                "drawn_address": Out(bank_address_bits(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        pixels = config.pixels_per_word

        ports = {}
        for name, width in (("depth", config.depth_bits), ("colour", config.colour_bits)):
            ram = memory.Memory(
                shape=pixels * width,
                depth=1 << bank_address_bits(config),
                init=[],
                # Nobody counts on a word that is read while it is written.
                attrs={"ram_style": "block", "no_rw_check": 1},
            )
            m.submodules[f"{name}_ram"] = ram
            ports[name] = ram.read_port(), ram.write_port(), ram.write_port()

        taken = Signal(BankRequestLayout(config))
        old = Signal(WordLayout(config))
        leaving = Signal(WordLayout(config), reset_less=True)
        with m.If(self.enable):
            m.d.sync += taken.eq(self.request)
        m.d.comb += [
            self.drawn.eq(taken.draw | taken.load),
            self.drawn_address.eq(taken.address),
            self.leaving.eq(leaving),
        ]
        for name, (read, load, write) in ports.items():
            m.d.comb += [
                read.addr.eq(self.request.address),
                read.en.eq(self.enable),
                # Of the same address and enable, so that the two are one port of the block RAM.
                load.addr.eq(self.request.address),
                load.en.eq(self.enable & self.request.load),
                load.data.eq(self.loaded[name]),
                old[name].as_value().eq(read.data),
                # Written every cycle while standing still, the word comes out the same each time.
                write.addr.eq(taken.address),
                write.en.eq(taken.draw | taken.clear),
            ]
            with m.If(self.enable):
                # A register is set or cleared for nothing, a multiplexer takes a LUT a bit.
                background = Const(-1 if name == "depth" else 0, len(read.data))
                m.d.sync += leaving[name].as_value().eq(Mux(taken.clear, read.data, background))
        merged = Signal(WordLayout(config))
        for pixel in range(pixels):
            new_depth, old_depth = self.new.depth[pixel], old.depth[pixel]
            passes = Signal(name=f"passes_{pixel}")
            m.d.comb += [
                # The mask rides on the comparison's carry chain, which has a bit to spare.
                passes.eq(Cat(new_depth, 1) < Cat(old_depth, taken.mask[pixel])),
                merged.depth[pixel].eq(
                    Mux(passes, new_depth, old_depth) | taken.clear.replicate(config.depth_bits)
                ),
                merged.colour[pixel].eq(
                    Mux(passes, self.new.colour[pixel], old.colour[pixel])
                    & ~taken.clear.replicate(config.colour_bits)
                ),
            ]
        m.d.comb += [
            ports["depth"][-1].data.eq(merged.depth),
            ports["colour"][-1].data.eq(merged.colour),
        ]
        return m
