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
    they are tested, and written.
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
        self.memories = OneWord(self.address)
        self.dut = dut = self.row(config)
        self.add(m, dut)
        self.free(m, dut)

        # What was requested in the two cycles before; and what the last three were to draw, the
        # first of which is known now.
        caught, tested = (Signal(RowRequestLayout(config), name=n) for n in ("asked", "tested"))
        news = [
            self._new(m, caught),
            *(Signal(PixelLayout(config), name=f"new_{n}") for n in (1, 2)),
        ]
        drew = Signal(2)  # what lay before what is caught was to be drawn
        # The registers without a reset have none of what they began with, stage by stage.
        begun = Signal(2)
        m.d.sync += [caught.eq(dut.request), tested.eq(caught), begun.eq(Cat(1, begun))]
        m.d.sync += [news[1].eq(news[0]), news[2].eq(news[1])]
        m.d.sync += drew.eq(Cat(caught.draw, tested.draw))
        self._assume_draws(m, caught, tested, news, drew)
        self._assume_distances(m, caught, tested)
        pixel, known = self._define(m, tested, news[1])
        self._assert_leaving(m, caught, pixel, known, begun)

    def _new(self, m, caught):
        """Return what the request of the cycle before draws or loads in the pixel's column."""
        new = Signal(PixelLayout(self.config), name="new_0")
        m.d.comb += new.eq(self.dut.new[self.column])
        return new

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

    def _loads(self, request):
        """Return whether a request loads the pixel."""
        return request.store & ~request.clear & (self.half | request.both) & self._there(request)

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
        # A draw of nothing may come with a clear.
        beside = (request.mask == 0) & request.clear
        self.given(m, "one_of_two", ~(request.draw & request.store) | beside)
        self.given(m, "stored", request.store | ~request.clear)
        load = request.store & ~request.clear
        self.given(m, "whole_words", ~load | (request.mask.all() & request.odd.all()))
        self.given(m, "both", load | ~request.both | (request.mask == 0))
        for n, before in enumerate((caught, tested)):
            again = Mux(self.half, request.again[n].odd, request.again[n].even)
            same = before.draw & (self._word(before) == self._word(request))
            other = before.draw & before.clear  # the word is that one's
            self.given(m, f"again_{n}", ~request.draw | other | (again == same))
            if not self.config.plane:
                told = caught.behind[n] == (news[0].depth >= news[n + 1].depth)
                self.given(m, f"behind_{n}", ~(caught.draw & drew[n]) | told)

    def _assume_distances(self, m, caught, tested):
        """Assume that what is cleared or loaded keeps its distance to what else is done there."""
        request = self.dut.request
        draws, loads, clears = self._draws(request), self._loads(request), self._clears(request)
        for n, before in enumerate((caught, tested)):
            loaded, drawn = self._loads(before), self._draws(before)
            # A word may be loaded after a clear, and the odd one twice: with the even one, and by
            # itself.
            cleared = clears & (drawn | loaded | self._clears(before))
            self.given(m, f"waits_{n}", ~cleared & ~(loads & drawn))
            line = before.clear & (self._group(before) == self._group(request))
            self.given(m, f"waits_too_{n}", ~(draws & (loaded | line)))

    def _background(self):
        """Return a pixel that nothing was drawn into."""
        return Const({"depth": self.config.background_depth}, PixelLayout(self.config))

    def _define(self, m, tested, new):
        """Return what the pixel is by definition, and whether it is known."""
        known = Signal()
        pixel, after = Signal(PixelLayout(self.config)), Signal(PixelLayout(self.config))
        m.d.comb += after.eq(pixel)
        with m.If(self._draws(tested) & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        loads, clears = self._loads(tested), self._clears(tested)
        with m.If(loads):
            m.d.comb += after.eq(new)
        with m.If(clears):
            m.d.comb += after.eq(self._background())
        m.d.sync += [pixel.eq(after), known.eq(known | clears | loads)]
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
                r"(request\.store), request\.mask",
                r"\1, -1",
                "_stages",
            ),
            Fault(
                "drawn unasked",
                LaneRow,
                r"Mux\(request\.draw \| request\.store, (request\.mask), 0\)",
                r"\1",
                "_stages",
            ),
            Fault(
                "loaded where it is nearer",
                LaneRow,
                r"Mux\(caught\.store, -1",
                "Mux(caught.clear, -1",
                "_meet",
            ),
            Fault("loaded into both", LaneRow, r" \| caught\.both", " | caught.store", "_stages"),
            Fault("not loaded", LaneRow, r" \| request\.store", "", "_stages"),
            Fault(
                "the column before",
                LaneRow,
                r"self\.new\[column\]",
                "self.new[(column + 1) % len(columns)]",
                "_stages",
            ),
            Fault("not cleared", LaneRow, r"Mux\(caught\.clear, 1, (mask.*)\)\)", r"\1)", "_test"),
            Fault(
                "cleared to a depth",
                LaneRow,
                r"Mux\(caught\.clear, background, (new\[column\])\)",
                r"\1",
                "_stages",
            ),
            Fault(
                "the colour not cleared",
                LaneRow,
                r"Mux\(caught\.clear, 0, (self\.new\[column\]\.colour)\)",
                r"\1",
                "_stages",
            ),
            Fault(
                "not cleared where it was drawn",
                LaneRow,
                r" & ~caught\.store",
                "",
                "_meet",
            ),
            Fault(
                "cleared where it is nearer",
                LaneRow,
                r"Mux\(caught\.store, -1, (.*)\)\)",
                r"\1)",
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
            Fault("as it was read", LaneRow, r"Mux\(meets,", "Mux(0,", "_meet"),
            Fault("as of another line", LaneRow, r" & \(now == last\)", "", "_meet"),
            Fault(
                "whatever was nearer",
                LaneRow,
                r"behind\.eq\(.*\[1\]\)",
                "behind.eq(0)",
                "_meet",
            ),
            Fault(
                "the stage before",
                LaneRow,
                r"behind\.eq\(.*\[1\]\)",
                "behind.eq(~caught.store & self.request.behind[1])",
                "_meet",
            ),
        ),
    )
]
