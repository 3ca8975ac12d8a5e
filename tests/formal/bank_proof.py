"""A bank keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal
from properties import OneWord, Properties, any_constant
from prove import Fault, Proof

from splatline.rtl.bank import Bank, BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.lane import PixelLayout
from splatline.rtl.layouts import WordLayout
from splatline.rtl.presets import PRESETS

__all__ = ["PROOFS"]


class BankProperties(Properties):
    """Any pixel of any word, followed from the first time that it is cleared or loaded.

    An access has one stage, in which its request has been taken: its word was read, and is written.
    A load has none: its word is written as it is requested.
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

        # What was requested last; ``new`` stays while all stands still.
        taken = Signal(BankRequestLayout(config))
        before = Signal(WordLayout(config))
        stood = Signal()
        with m.If(dut.enable):
            m.d.sync += taken.eq(dut.request)
        m.d.sync += [before.eq(dut.new), stood.eq(~dut.enable)]
        request = dut.request
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", (wishes & (wishes - 1)) == 0)
        same = wishes.any() & (taken.draw | taken.clear) & (request.address == taken.address)
        self.given(m, "waits", ~(dut.enable & same))
        self.given(m, "new_steady", ~stood | (before == dut.new))

        # The definition.
        known, mine = Signal(), Signal()
        pixel, after = Signal(PixelLayout(config)), Signal(PixelLayout(config))
        new, old, leaving = pick(dut.new), pick(dut.old), pick(dut.leaving)
        background = Const({"depth": config.background_depth}, PixelLayout(config))
        covered = taken.mask.bit_select(number, 1)
        m.d.comb += [mine.eq(taken.address == address), after.eq(pixel)]
        with m.If(mine & taken.draw & covered & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        with m.If(mine & taken.clear):
            m.d.comb += after.eq(background)
        with m.If(dut.enable):
            m.d.sync += [pixel.eq(after), known.eq(known | (mine & taken.clear))]
            with m.If(request.load & (request.address == address)):
                m.d.sync += [pixel.eq(pick(dut.loaded)), known.eq(1)]

        # What was cleared one request before, as it was then, if that is known.
        used = known & mine & (taken.draw | taken.clear)
        left, left_known, gone = Signal(), Signal(), Signal(PixelLayout(config))
        begun = Signal()  # the register has none of what it began with
        with m.If(dut.enable):
            m.d.sync += [
                left.eq(taken.clear),
                left_known.eq(used & taken.clear),
                gone.eq(pixel),
                begun.eq(1),
            ]
        self.always(m, "leaves", ~left_known | (leaving == gone))
        self.always(m, "nothing_else", ~begun | left | (leaving == background))
        self.lemma(m, "read", ~used | (old == pixel))
        self.always(
            m,
            "drawn",
            (dut.drawn == (taken.draw | taken.load))
            & (~dut.drawn | (dut.drawn_address == taken.address)),
        )
        # What makes the induction close: the memory has the pixel, or already what comes of it.
        (depths,), (colours,) = self.memories.words

        def cut(depths, colours):
            """Return the pixel out of what the memories have."""
            kept = Signal(PixelLayout(config))
            m.d.comb += [
                kept.depth.eq(depths.word_select(number, config.depth_bits)),
                kept.colour.eq(colours.word_select(number, config.colour_bits)),
            ]
            return kept

        cleared = mine & taken.clear & stood  # as it was in the cycle before
        due = PixelLayout(config)(Mux((used & stood) | cleared, after, pixel))
        self.lemma(m, "kept", ~(known | cleared) | (cut(depths, colours) == due))
        self.lemma(m, "taken", dut.taken == taken)


SEEN = tuple(
    Fault(f"lemmas look at {name}", Bank, rf"\b{name} = ", f"{name} = self.{name} = ")
    for name in ("taken", "old")
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
            Fault(
                "written too early",
                Bank,
                r"write\.addr\.eq\(taken",
                "write.addr.eq(self.request",
            ),
            Fault(
                "does not stand still", Bank, r"m\.If\(self\.enable\)(:\s+.*taken)", r"m.If(1)\1"
            ),
            Fault("the word is not held", Bank, r"read\.en\.eq\(self\.enable\)", "read.en.eq(1)"),
            Fault("the colour stays", Bank, r"& ~taken\.clear\.replicate\(.*\)", ""),
            Fault("what is drawn leaves", Bank, r"Mux\(taken\.clear, ", "Mux(1, "),
            Fault("all pixels", Bank, r"taken\.mask\[pixel\]", "1"),
            Fault(
                "loaded while it stands still", Bank, r"self\.enable & (self\.request\.load)", r"\1"
            ),
            Fault("loaded too late", Bank, r"load\.addr\.eq\(self\.request", "load.addr.eq(taken"),
            Fault("a load unmarked", Bank, r" \| taken\.load", ""),
            Fault(
                "written over what is loaded",
                Bank,
                r"(en\.eq\(taken\.draw) \|",
                r"\1 | taken.load |",
            ),
        ),
    )
]
