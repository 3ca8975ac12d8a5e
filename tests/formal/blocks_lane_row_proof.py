"""A row of lanes keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal

from splatline.rtl.blocks.lane_row import HALVES, LaneRow, RowRequestLayout, row_address_bits
from splatline.rtl.layouts import PixelLayout
from tests.formal.properties import SWIFT_NINE, OneWord, Properties, any_constant
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS", "LaneRowProperties"]


class LaneRowProperties(Properties):
    """Any one pixel of any word, followed from the first time that it is cleared or loaded.

    It lies in any column and either half. A request has two more stages: its pixels were read, and
    they are tested, and written. A load has none.
    """

    row = LaneRow

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the row and its properties."""
        config = self.config
        self.address = any_constant(m, row_address_bits(config), "address")
        self.column = any_constant(m, config.pixel_bits, "column")
        self.half = any_constant(m, 1, "half")
        # That its two writers keep apart is assumed of the pixel, and of no other one.
        self.memories = OneWord(self.address, apart=False)
        self.dut = dut = self.row(config)
        self.add(m, dut)
        self.free(m, dut)

        # What was requested in the two cycles before; and what the last three were to draw, the
        # first of which is known now.
        caught, tested = (Signal(RowRequestLayout(config), name=n) for n in ("asked", "tested"))
        news = [self._new(m), *(Signal(PixelLayout(config), name=f"new_{n}") for n in (1, 2))]
        drew = Signal(2)  # what lay before what is caught was to be drawn
        # The registers without a reset have none of what they began with, stage by stage.
        begun = Signal(2)
        m.d.sync += [caught.eq(dut.request), tested.eq(caught), begun.eq(Cat(1, begun))]
        m.d.sync += [news[1].eq(news[0]), news[2].eq(news[1])]
        m.d.sync += drew.eq(Cat(caught.draw, tested.draw))
        self._assume_draws(m, caught, tested, news, drew)
        loads = self._assume_clears(m, caught, tested)
        # What the row may write at first is cleared, and not yet loaded.
        self.given(m, "begins", begun[1] | ~loads)
        pixel, known = self._define(m, tested, news[1], loads)
        self._assert_leaving(m, caught, pixel, known, begun)

    def _new(self, m):
        """Return the pixel that the request of the cycle before draws."""
        return self.dut.new

    def _pick(self, m, words):
        """Return the chosen pixel of two words."""
        pixel = Signal(PixelLayout(self.config))
        even, odd = (getattr(words, name) for name in HALVES)
        m.d.comb += [
            pixel.depth.eq(Mux(self.half, odd.depth[self.column], even.depth[self.column])),
            pixel.colour.eq(Mux(self.half, odd.colour[self.column], even.colour[self.column])),
        ]
        return pixel

    def _there(self, request):
        """Return whether a request's word of the pixel's half is the pixel's."""
        return Mux(self.half, request.addresses.odd, request.addresses.even) == self.address

    def _draws(self, request):
        """Return whether a request draws the pixel."""
        column, half = self.column, self.half
        mine = request.mask.bit_select(column, 1) & (request.odd.bit_select(column, 1) == half)
        return request.draw & mine & self._there(request)

    def _clears(self, request):
        """Return whether a request clears the pixel."""
        return request.clear & self._there(request)

    def _word(self, request):
        """Return the word of a line that a request has in the pixel's half."""
        bits = self.config.word_bits - 1
        return Mux(self.half, request.addresses.odd[:bits], request.addresses.even[:bits])

    def _group(self, request):
        """Return the group of the line that a request's word of the pixel's half is of."""
        bits = self.config.word_bits - 1
        return Mux(self.half, request.addresses.odd[bits:], request.addresses.even[bits:])

    def _assume_draws(self, m, caught, tested, news, drew):
        """Assume one request a cycle, and that a draw says what was drawn before it.

        It says so of the pixel's half, and nothing of the group of lines.
        """
        request = self.dut.request
        # A draw of nothing may come with another.
        beside = request.draw & (request.mask == 0) & ~(request.clear & request.load)
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", ((wishes & (wishes - 1)) == 0) | beside)
        for n, before in enumerate((caught, tested)):
            again = Mux(self.half, request.again[n].odd, request.again[n].even)
            same = before.draw & (self._word(before) == self._word(request))
            other = before.draw & (before.clear | before.load)  # the word is that one's
            self.given(m, f"again_{n}", ~request.draw | other | (again == same))
            if not self.config.plane:
                told = caught.behind[n] == (self.dut.new.depth >= news[n + 1].depth)
                self.given(m, f"behind_{n}", ~(caught.draw & drew[n]) | told)

    def _assume_clears(self, m, caught, tested):
        """Assume that clears and loads keep their distance; return whether the pixel is loaded."""
        request = self.dut.request
        loads, clears_now = Signal(), Signal()
        m.d.comb += [
            loads.eq(request.load & self._there(request)),
            clears_now.eq(loads | self._clears(request)),
        ]
        for n, before in enumerate((caught, tested)):
            cleared, drawn = self._clears(before), self._draws(before)
            self.given(m, f"waits_{n}", ~(clears_now & (cleared | drawn)))
            line = before.clear & (self._group(before) == self._group(request))
            self.given(m, f"waits_too_{n}", ~(self._draws(request) & line))
        return loads

    def _background(self):
        """Return a pixel that nothing was drawn into."""
        return Const({"depth": self.config.background_depth}, PixelLayout(self.config))

    def _define(self, m, tested, new, loads):
        """Return what the pixel is by definition, and whether it is known."""
        known = Signal()
        pixel, after = Signal(PixelLayout(self.config)), Signal(PixelLayout(self.config))
        m.d.comb += after.eq(pixel)
        with m.If(self._draws(tested) & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        with m.If(self._clears(tested)):
            m.d.comb += after.eq(self._background())
        m.d.sync += [pixel.eq(after), known.eq(known | self._clears(tested))]
        with m.If(loads):
            m.d.sync += [pixel.eq(self._pick(m, self.dut.loaded)), known.eq(1)]
        return pixel, known

    def _assert_leaving(self, m, caught, pixel, known, begun):
        """Assert that what was cleared two cycles before leaves as it was then, if it is known."""
        dut, background = self.dut, self._background()
        left, left_known, gone = Signal(), Signal(), Signal(PixelLayout(self.config))
        m.d.sync += [
            left.eq(caught.clear),
            left_known.eq(known & self._clears(caught)),
            gone.eq(pixel),
        ]
        outside = Signal(2)  # of the last two cycles
        now = Mux(self.half, dut.outside.odd, dut.outside.even).bit_select(self.column, 1)
        m.d.sync += outside.eq(Cat(now, outside))
        leaving = self._pick(m, dut.leaving)
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
                "_depths",
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
                r" & ~caught\.clear",
                "",
                "_meet",
            ),
            Fault(
                "nor where it was so before",
                LaneRow,
                r" & ~self\.request\.clear",
                "",
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
                r"behind\.eq\(caught\.behind\[1\]\)",
                "behind.eq(0)",
                "_meet",
            ),
            Fault(
                "the stage before",
                LaneRow,
                r"behind\.eq\(caught\.behind\[1\]\)",
                "behind.eq(self.request.behind[1])",
                "_meet",
            ),
        ),
    )
]
