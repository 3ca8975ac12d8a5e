"""A row of lanes keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal

from splatline.rtl.blocks.lane_row import HALVES, LaneRow, RowRequestLayout, row_address_bits
from splatline.rtl.layouts import PixelLayout
from tests.formal.properties import SWIFT_NINE, OneWord, Properties, any_constant
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]


class LaneRowProperties(Properties):
    """Any one pixel of any word, followed from the first time that it is cleared or loaded.

    It lies in any column and either half. A request has two more stages: its pixels were read, and
    they are tested, and written. A load has none.
    """

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the row and its properties."""
        config = self.config
        address = any_constant(m, row_address_bits(config), "address")
        column = any_constant(m, config.pixel_bits, "column")
        half = any_constant(m, 1, "half")
        # That its two writers keep apart is assumed of the pixel, and of no other one.
        self.memories = OneWord(address, apart=False)
        dut = LaneRow(config)
        self.add(m, dut)
        self.free(m, dut)

        def pick(words):
            """Return the chosen pixel of two words."""
            pixel = Signal(PixelLayout(config))
            even, odd = (getattr(words, name) for name in HALVES)
            m.d.comb += [
                pixel.depth.eq(Mux(half, odd.depth[column], even.depth[column])),
                pixel.colour.eq(Mux(half, odd.colour[column], even.colour[column])),
            ]
            return pixel

        def there(request):
            """Return whether a request's word of that half is the pixel's."""
            return Mux(half, request.addresses.odd, request.addresses.even) == address

        def draws(request):
            """Return whether a request draws the pixel."""
            mine = request.mask.bit_select(column, 1) & (request.odd.bit_select(column, 1) == half)
            return request.draw & mine & there(request)

        def clears(request):
            """Return whether a request clears the pixel."""
            return request.clear & there(request)

        # What was requested in the two cycles before; and what the last three were to draw, the
        # first of which is known now.
        caught, tested = (Signal(RowRequestLayout(config), name=n) for n in ("asked", "tested"))
        news = [dut.new, *(Signal(PixelLayout(config), name=f"new_{n}") for n in (1, 2))]
        drew = Signal(2)  # what lay before what is caught was to be drawn
        # The registers without a reset have none of what they began with, stage by stage.
        begun = Signal(2)
        m.d.sync += [caught.eq(dut.request), tested.eq(caught), begun.eq(Cat(1, begun))]
        m.d.sync += [news[1].eq(news[0]), news[2].eq(news[1])]
        m.d.sync += drew.eq(Cat(caught.draw, tested.draw))
        request = dut.request
        # A draw of nothing may come with another.
        beside = request.draw & (request.mask == 0) & ~(request.clear & request.load)
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", ((wishes & (wishes - 1)) == 0) | beside)

        # Each draw says what was drawn before it, of the pixel's half: of the group of lines it
        # tells nothing.
        def word(request):
            """Return the word of a line that a request has in that half."""
            bits = config.word_bits - 1
            return Mux(half, request.addresses.odd[:bits], request.addresses.even[:bits])

        def group(request):
            """Return the group of the line that a request's word of that half is of."""
            bits = config.word_bits - 1
            return Mux(half, request.addresses.odd[bits:], request.addresses.even[bits:])

        for n, before in enumerate((caught, tested)):
            again = Mux(half, request.again[n].odd, request.again[n].even)
            same = before.draw & (word(before) == word(request))
            other = before.draw & (before.clear | before.load)  # the word is that one's
            self.given(m, f"again_{n}", ~request.draw | other | (again == same))
            told = caught.behind[n] == (dut.new.depth >= news[n + 1].depth)
            self.given(m, f"behind_{n}", ~(caught.draw & drew[n]) | told)

        loads, clears_now = Signal(), Signal()
        m.d.comb += [
            loads.eq(request.load & there(request)),
            clears_now.eq(loads | clears(request)),
        ]
        for n, before in enumerate((caught, tested)):
            cleared, drawn = clears(before), draws(before)
            self.given(m, f"waits_{n}", ~(clears_now & (cleared | drawn)))
            line = before.clear & (group(before) == group(request))
            self.given(m, f"waits_too_{n}", ~(draws(request) & line))
        # What the row may write at first is cleared, and not yet loaded.
        self.given(m, "begins", begun[1] | ~loads)

        # The definition.
        known = Signal()
        pixel, after = Signal(PixelLayout(config)), Signal(PixelLayout(config))
        background = Const({"depth": config.background_depth}, PixelLayout(config))
        m.d.comb += after.eq(pixel)
        with m.If(draws(tested) & (news[1].depth < pixel.depth)):
            m.d.comb += after.eq(news[1])
        with m.If(clears(tested)):
            m.d.comb += after.eq(background)
        m.d.sync += [pixel.eq(after), known.eq(known | clears(tested))]
        with m.If(loads):
            m.d.sync += [pixel.eq(pick(dut.loaded)), known.eq(1)]

        # What was cleared two cycles before, as it was then, if that is known.
        left, left_known, gone = Signal(), Signal(), Signal(PixelLayout(config))
        m.d.sync += [
            left.eq(caught.clear),
            left_known.eq(known & clears(caught)),
            gone.eq(pixel),
        ]
        outside = Signal(2)  # of the last two cycles
        now = Mux(half, dut.outside.odd, dut.outside.even).bit_select(column, 1)
        m.d.sync += outside.eq(Cat(now, outside))
        leaving = pick(dut.leaving)
        expected = Mux(outside[1], background.as_value(), gone.as_value())
        self.always(m, "leaves", ~left_known | (leaving.as_value() == expected))
        self.always(m, "nothing_else", ~begun[1] | left | (leaving == background))


PROOFS = [
    Proof(
        name="lane row: pixel",
        shows="a pixel is what was drawn nearest since it was loaded or cleared",
        build=lambda: LaneRowProperties(SWIFT_NINE),
        depth=12,
        engine="abc bmc3",
        faults=(
            Fault("no depth test", LaneRow, r"difference\[-1\] & ", "", "_test"),
            Fault("ties drawn", LaneRow, r"Cat\(other, behind \^ meets\)", r"\g<0> - 1", "_test"),
            Fault(
                "the other half",
                LaneRow,
                r"(olds\[.)odd(.\], olds\[.)even",
                r"\1even\2odd",
                "_test",
            ),
            Fault(
                "drawn into both halves",
                LaneRow,
                r"passes & ~not_even\[column\] &",
                "passes &",
                "_test",
            ),
            Fault(
                "all columns",
                LaneRow,
                r"mask\.eq\(Mux\(request\.draw, request\.mask",
                "mask.eq(Mux(request.draw, -1",
                "_stages",
            ),
            Fault(
                "drawn where it is loaded",
                LaneRow,
                r"Mux\(request\.draw, request\.mask, 0\)",
                "request.mask",
                "_stages",
            ),
            Fault(
                "loaded too late",
                LaneRow,
                r"load\.addr\.eq\(address\)",
                "load.addr.eq(getattr(stages.caught.addresses, half))",
                "_memory",
            ),
            Fault("not cleared", LaneRow, r"Mux\(caught\.clear, 1, (mask.*)\)\)", r"\1)", "_test"),
            Fault(
                "cleared to a depth",
                LaneRow,
                r"(depth\.eq\()Mux\([^,]*, background, (.*)\)\)",
                r"\1\2)",
                "_stages",
            ),
            Fault(
                "the colour not cleared",
                LaneRow,
                r"Mux\(caught\.clear, 0, (self\.new\.colour)\)",
                r"\1",
                "_stages",
            ),
            Fault(
                "not cleared where it was drawn",
                LaneRow,
                r"(?<=hides) & ~caught\.clear",
                "",
                "_meet",
            ),
            # Either condition is enough for a clear, so the fault takes both away.
            Fault(
                "nor where it was so before",
                LaneRow,
                r" & ~caught\.clear(\),\n(?s:.*)) & ~self\.request\.clear",
                r"\1",
                "_meet",
            ),
            Fault(
                "leaves where nothing is cleared",
                LaneRow,
                r"Mux\(keep, self\.config\.background_depth, (pixel\.depth)\)",
                r"\1",
                "_leave",
            ),
            Fault("leaves from outside", LaneRow, r"Mux\(outside, 1, (.*)\)\)", r"\1)", "_keep"),
            Fault("as it was a cycle before", LaneRow, r"Mux\(hides & [^,]+,", "Mux(0,", "_meet"),
            Fault("hidden by another line", LaneRow, r" & \(then == last\)", "", "_meet"),
            Fault("hidden by what is behind", LaneRow, r" & caught\.behind\[0\]", "", "_meet"),
            Fault("as it was read", LaneRow, r"Mux\(meets & [^,]+,", "Mux(0,", "_meet"),
            Fault("as of another line", LaneRow, r" & \(now == last\)", "", "_meet"),
            Fault(
                "whatever was nearer",
                LaneRow,
                r"behind\.eq\(caught\.behind\[1\] & ~caught\.clear\)",
                "behind.eq(0)",
                "_meet",
            ),
            Fault(
                "the stage before",
                LaneRow,
                r"behind\.eq\(caught\.behind\[1\] & ~caught\.clear\)",
                "behind.eq(self.request.behind[1])",
                "_meet",
            ),
        ),
    )
]
