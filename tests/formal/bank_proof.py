"""A bank keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal
from properties import OneWord, Properties, any_constant
from prove import Fault, Proof

from splatline.rtl.bank import Bank, BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.format import PRESETS
from splatline.rtl.lane import PixelLayout
from splatline.rtl.layouts import WordLayout

__all__ = ["PROOFS"]


class BankProperties(Properties):
    """Any pixel of any word, followed from the first time that it is cleared or loaded.

    An access has two stages: its request has been taken (the word is read), and its word stands on
    a register and is written. A load has none: its word is written as it is requested.
    """

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

        # What was requested last, and before; ``new`` stays while all stands still.
        taken, asked = (Signal(BankRequestLayout(config), name=name) for name in STAGES)
        before = Signal(WordLayout(config))
        stood = Signal()
        with m.If(dut.enable):
            m.d.sync += [taken.eq(dut.request), asked.eq(taken)]
        m.d.sync += [before.eq(dut.new), stood.eq(~dut.enable)]
        request = dut.request
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", (wishes & (wishes - 1)) == 0)
        for stage, name in zip((taken, asked), STAGES, strict=True):
            same = wishes.any() & (stage.draw | stage.clear)
            same = same & (request.address == stage.address)
            self.given(m, f"waits_for_{name}", ~(dut.enable & same))
        self.given(m, "new_steady", ~stood | (before == dut.new))

        # The definition.
        known, mine = Signal(), Signal()
        pixel, after = Signal(PixelLayout(config)), Signal(PixelLayout(config))
        new, old, leaving = pick(dut.new), pick(dut.word), pick(dut.leaving)
        background = Const({"depth": config.background_depth}, PixelLayout(config))
        covered = asked.mask.bit_select(number, 1)
        m.d.comb += [mine.eq(asked.address == address), after.eq(pixel)]
        with m.If(mine & asked.draw & covered & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        with m.If(mine & asked.clear):
            m.d.comb += after.eq(background)
        with m.If(dut.enable):
            m.d.sync += [pixel.eq(after), known.eq(known | (mine & asked.clear))]
            with m.If(request.load & (request.address == address)):
                m.d.sync += [pixel.eq(pick(dut.loaded)), known.eq(1)]

        used = known & mine & (asked.draw | asked.clear)
        begun = Signal()  # the registers have none of what they began with
        with m.If(dut.enable):
            m.d.sync += begun.eq(1)
        self.always(m, "leaves", ~(used & asked.clear) | (leaving == pixel))
        self.always(m, "nothing_else", ~begun | asked.clear | (leaving == background))
        self.lemma(m, "read", ~used | (old == pixel))
        self.lemma(m, "begun", begun | ~Cat(asked.draw, asked.clear).any())
        self.always(
            m,
            "drawn",
            (dut.drawn == (taken.draw | taken.load))
            & (~dut.drawn | (dut.drawn_address == taken.address)),
        )
        # What makes the induction close: the memory has the pixel, or already what comes of it; so
        # has its port, if the pixel was read last.
        (depths,), (colours,) = self.memories.words

        def cut(depths, colours):
            """Return the pixel out of what the memories have."""
            kept = Signal(PixelLayout(config))
            m.d.comb += [
                kept.depth.eq(depths.word_select(number, config.depth_bits)),
                kept.colour.eq(colours.word_select(number, config.colour_bits)),
            ]
            return kept

        cleared = mine & asked.clear & stood  # as it was in the cycle before
        due = PixelLayout(config)(Mux((used & stood) | cleared, after, pixel))
        self.lemma(m, "kept", ~(known | cleared) | (cut(depths, colours) == due))
        self.lemma(m, "stages", (dut.taken == taken) & (dut.merging == asked))
        # It is written in the first cycle in which it stands there, and no more.
        asks = asked.draw | asked.clear
        self.lemma(m, "fresh", ~(dut.fresh & stood) & (dut.fresh | stood | ~asks))
        read = cut(*(read.data for read, *_ in dut.ports.values()))
        uses = known & (taken.address == address) & (taken.draw | taken.clear)
        self.lemma(m, "port", ~uses | (read == pixel))
        both = (taken.draw | taken.clear) & (asked.draw | asked.clear)
        self.lemma(m, "neighbours", ~both | (taken.address != asked.address))


STAGES = ("taken", "merging")

SEEN = tuple(
    Fault(f"lemmas look at {name}", Bank, rf"\b{name} = ", f"{name} = self.{name} = ")
    for name in (*STAGES, "fresh", "ports", "word")
)


PROOFS = [
    Proof(
        name="bank: pixel",
        shows="a pixel is what was drawn nearest since it was loaded or cleared, with any stalls",
        build=lambda: BankProperties(PRESETS["wide"]),
        depth=3,
        endless=True,
        engine="smtbmc z3",
        fault_engine="smtbmc boolector",
        changes=SEEN,
        faults=(
            Fault("no depth test", Bank, r"Cat\(new_depth, 1\)", "Cat(new_depth & 0, 1)"),
            Fault("ties drawn", Bank, r"\) < Cat\(", ") <= Cat("),
            Fault("written too early", Bank, r"write\.addr\.eq\(merging", "write.addr.eq(taken"),
            Fault(
                "does not stand still", Bank, r"m\.If\(self\.enable\)(:\s+.*taken)", r"m.If(1)\1"
            ),
            Fault(
                "the word is not held", Bank, r"m\.If\(self\.enable\)(:\s+.*word\[)", r"m.If(1)\1"
            ),
            Fault("the colour stays", Bank, r"& ~merging\.clear\.replicate\(.*\)", ""),
            Fault("what is drawn leaves", Bank, r"Mux\(taken\.clear, ", "Mux(1, "),
            Fault("all pixels", Bank, r"merging\.mask\[pixel\]", "1"),
            Fault(
                "loaded while it stands still", Bank, r"self\.enable & (self\.request\.load)", r"\1"
            ),
            Fault("loaded too late", Bank, r"load\.addr\.eq\(self\.request", "load.addr.eq(taken"),
            Fault("a load unmarked", Bank, r" \| taken\.load", ""),
            Fault(
                "written over what is loaded", Bank, r"(merging\.draw) \|", r"\1 | merging.load |"
            ),
        ),
    )
]
