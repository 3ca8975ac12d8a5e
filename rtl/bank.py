"""A bank of the window: one block RAM of depth, one of colour, and the writer between them."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .layouts import WordLayout

__all__ = ["Bank", "BankRequestLayout", "bank_address_bits"]


class BankRequestLayout(data.StructLayout):
    """What a bank is asked to do in a cycle.

    ``draw``: depth-test the pixels of ``mask`` of the word at ``address``. ``clear``: read that
    word and leave background in it. At most one of the two.
    """

    def __init__(self, config: EngineConfig):
        super().__init__(
            {
                "draw": 1,
                "clear": 1,
                "mask": config.pixels_per_word,
                "address": bank_address_bits(config),
            }
        )


def bank_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a bank: two for its lines, the rest for half a line's words.

    A bank holds the even words of two lines of the window and the odd words of two others.
    """
    return 2 + config.word_bits - 1


class Bank(wiring.Component):
    """Reads a word, tests and merges its pixels, and writes it back.

    The block RAM has one read and one write port and no byte enables, so a word is always written
    whole. The word is read in the cycle of the request; in the next it stands on ``old``, is
    compared and merged with ``new``, and is written at that cycle's end. A request for the word
    that is being written at the moment would read stale pixels: ``conflict`` says so, and the
    request must wait a cycle.

    **Latency**: 1 cycle to ``old``, 2 to the memory. **Throughput**: one request a cycle, but not
    the same word in two neighbouring cycles.

    Members
    -------
    enable : In(1)
        Low: everything stands still, and ``request`` is not taken.
    request : In(BankRequestLayout)
        What to do. Never raised while ``conflict`` is high.
    new : In(WordLayout)
        Depth and colour to draw, one a pixel, in the cycle after the request.
    conflict : Out(1)
        The word at ``request.address`` is being written now.
    old : Out(WordLayout)
        The word as it was before the last request taken.
    drawn : Out(1)
        Pixels were requested to be drawn one cycle before, into the word at ``drawn_address``.
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
                "conflict": Out(1),
                "old": Out(WordLayout(config)),
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
                attrs={"ram_style": "block"},
            )
            m.submodules[f"{name}_ram"] = ram
            ports[name] = ram.read_port(), ram.write_port()

        taken = Signal(BankRequestLayout(config))
        with m.If(self.enable):
            m.d.sync += taken.eq(self.request)
        m.d.comb += [self.drawn.eq(taken.draw), self.drawn_address.eq(taken.address)]
        m.d.comb += self.conflict.eq(
            (taken.draw | taken.clear) & (taken.address == self.request.address)
        )
        for name, (read, write) in ports.items():
            m.d.comb += [
                read.addr.eq(self.request.address),
                read.en.eq(self.enable),
                self.old[name].as_value().eq(read.data),
                write.addr.eq(taken.address),
                # Written every cycle while standing still, the word comes out the same each time.
                write.en.eq(taken.draw | taken.clear),
            ]
        merged = Signal(WordLayout(config))
        for pixel in range(pixels):
            new_depth, old_depth = self.new.depth[pixel], self.old.depth[pixel]
            passes = Signal(name=f"passes_{pixel}")
            m.d.comb += [
                # The mask rides on the comparison's carry chain, which has a bit to spare.
                passes.eq(Cat(new_depth, 1) < Cat(old_depth, taken.mask[pixel])),
                merged.depth[pixel].eq(
                    Mux(passes, new_depth, old_depth) | taken.clear.replicate(config.depth_bits)
                ),
                merged.colour[pixel].eq(
                    Mux(passes, self.new.colour[pixel], self.old.colour[pixel])
                    & ~taken.clear.replicate(config.colour_bits)
                ),
            ]
        m.d.comb += [
            ports["depth"][1].data.eq(merged.depth),
            ports["colour"][1].data.eq(merged.colour),
        ]
        return m
