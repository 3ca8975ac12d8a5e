"""A bank keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Const, Mux, Signal
from properties import OneWord, Properties, any_constant
from prove import Fault, Proof

from splatline.rtl.bank import Bank, BankRequestLayout, bank_address_bits
from splatline.rtl.format import PRESETS
from splatline.rtl.lane import PixelLayout
from splatline.rtl.layouts import WordLayout

__all__ = ["PROOFS"]


class BankProperties(Properties):
    """Any pixel of any word, followed by the definition from the first time it is cleared."""

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the bank and its properties."""
        config = self.config
        address = any_constant(m, bank_address_bits(config), "address")
        number = any_constant(m, config.pixel_bits, "number")
        self.memories = OneWord(address)
        dut = Bank(config)
        self.add(m, dut)
        self.free(m, dut)

        def pick(word):
            """Return the chosen pixel of a word."""
            pixel = Signal(PixelLayout(config))
            m.d.comb += [
                pixel.depth.eq(word.depth[number]),
                pixel.colour.eq(word.colour[number]),
            ]
            return pixel

        # What was requested last; its ``new`` stays while all stands still.
        asked = Signal(BankRequestLayout(config))
        before = Signal(WordLayout(config))
        stood = Signal()
        with m.If(dut.enable):
            m.d.sync += asked.eq(dut.request)
        m.d.sync += [before.eq(dut.new), stood.eq(~dut.enable)]
        wanted = dut.request.draw | dut.request.clear
        self.given(m, "one_of_two", ~(dut.request.draw & dut.request.clear))
        self.given(m, "waits", ~(wanted & dut.conflict))
        self.given(m, "new_steady", ~stood | (before == dut.new))

        # The definition.
        known, mine = Signal(), Signal()
        pixel, after = Signal(PixelLayout(config)), Signal(PixelLayout(config))
        new, old = pick(dut.new), pick(dut.old)
        background = Const({"depth": config.background_depth}, PixelLayout(config))
        m.d.comb += [mine.eq(asked.address == address), after.eq(pixel)]
        with m.If(mine & asked.draw & asked.mask.bit_select(number, 1) & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        with m.If(mine & asked.clear):
            m.d.comb += after.eq(background)
        with m.If(dut.enable):
            m.d.sync += [pixel.eq(after), known.eq(known | (mine & asked.clear))]

        used = known & mine & (asked.draw | asked.clear)
        self.always(m, "read", ~used | (old == pixel))
        self.always(
            m,
            "drawn",
            (dut.drawn == asked.draw) & (~dut.drawn | (dut.drawn_address == asked.address)),
        )
        # What makes the induction close: the memory has the pixel, or already what comes of it.
        (depths,), (colours,) = self.memories.words
        kept = Signal(PixelLayout(config))
        m.d.comb += [
            kept.depth.eq(depths.word_select(number, config.depth_bits)),
            kept.colour.eq(colours.word_select(number, config.colour_bits)),
        ]
        due = PixelLayout(config)(Mux(used & stood, after, pixel))
        self.lemma(m, "kept", ~known | (kept == due))


PROOFS = [
    Proof(
        name="bank: pixel",
        shows="a pixel is what was drawn nearest since it was cleared, with any stalls",
        build=lambda: BankProperties(PRESETS["wide"]),
        depth=8,
        endless=True,
        faults=(
            Fault("no depth test", Bank, r"Cat\(new_depth, 1\)", "Cat(new_depth & 0, 1)"),
            Fault("ties drawn", Bank, r"\) < Cat\(", ") <= Cat("),
            Fault("no conflict", Bank, r"taken\.draw \| taken\.clear\) &", "taken.clear) &"),
            Fault("does not stand still", Bank, r"m\.If\(self\.enable\)", "m.If(1)"),
            Fault("the colour stays", Bank, r"& ~taken\.clear\.replicate\(.*\)", ""),
            Fault("all pixels", Bank, r"taken\.mask\[pixel\]", "1"),
        ),
    )
]
