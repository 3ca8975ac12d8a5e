"""A row of lanes keeps the nearest pixels, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal
from properties import OneWord, Properties, any_constant
from prove import Fault, Proof

from splatline.rtl.lane import PixelLayout
from splatline.rtl.lane_row import HALVES, LaneRow, RowRequestLayout, row_address_bits
from splatline.rtl.presets import SWIFT

__all__ = ["PROOFS"]


class LaneRowProperties(Properties):
    """Any one pixel of any word, followed from the first time that it is cleared or loaded.

    It lies in any column and either half. A request has one stage, in which it has been taken: its
    pixels were read, and are written. A load has none.
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

        # What was requested last, with what was to be drawn.
        taken, new = Signal(RowRequestLayout(config)), Signal(PixelLayout(config))
        begun = Signal()  # the registers without a reset have none of what they began with
        m.d.sync += [taken.eq(dut.request), new.eq(dut.new), begun.eq(1)]
        request = dut.request
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", (wishes & (wishes - 1)) == 0)
        loads, alters = Signal(), Signal()
        m.d.comb += [
            loads.eq(request.load & there(request)),
            alters.eq(draws(taken) | clears(taken)),
        ]
        asked = draws(request) | clears(request) | loads
        self.given(m, "waits", ~(asked & alters))
        # What the row may write at first is cleared, and not yet loaded.
        self.given(m, "begins", begun | ~loads)

        # The definition.
        known = Signal()
        pixel, after = Signal(PixelLayout(config)), Signal(PixelLayout(config))
        background = Const({"depth": config.background_depth}, PixelLayout(config))
        m.d.comb += after.eq(pixel)
        with m.If(draws(taken) & (new.depth < pixel.depth)):
            m.d.comb += after.eq(new)
        with m.If(clears(taken)):
            m.d.comb += after.eq(background)
        m.d.sync += [pixel.eq(after), known.eq(known | clears(taken))]
        with m.If(loads):
            m.d.sync += [pixel.eq(pick(dut.loaded)), known.eq(1)]

        # What was cleared one request before, as it was then, if that is known.
        left, left_known, gone = Signal(), Signal(), Signal(PixelLayout(config))
        m.d.sync += [
            left.eq(taken.clear),
            left_known.eq(known & clears(taken)),
            gone.eq(pixel),
        ]
        leaving = pick(dut.leaving)
        self.always(m, "leaves", ~left_known | (leaving == gone))
        self.always(m, "nothing_else", ~begun | left | (leaving == background))


PROOFS = [
    Proof(
        name="lane row: pixel",
        shows="a pixel is what was drawn nearest since it was loaded or cleared",
        build=lambda: LaneRowProperties(SWIFT),
        depth=12,
        engine="abc bmc3",
        faults=(
            Fault("no depth test", LaneRow, r"difference\[-1\] & ", ""),
            Fault("ties drawn", LaneRow, r"difference\.eq\(depth - ", "difference.eq(depth - 1 - "),
            Fault("the other half", LaneRow, r"Mux\(is_odd, odd\.data", "Mux(~is_odd, odd.data"),
            Fault("drawn into both halves", LaneRow, r" & ~is_odd\)", ")"),
            Fault(
                "all columns",
                LaneRow,
                r"mask\.eq\(Mux\(request\.draw, request\.mask",
                "mask.eq(Mux(request.draw, -1",
            ),
            Fault(
                "drawn where it is loaded",
                LaneRow,
                r"Mux\(request\.draw, request\.mask, 0\)",
                "request.mask",
            ),
            Fault(
                "loaded too late",
                LaneRow,
                r"load\.addr\.eq\(getattr\(request",
                "load.addr.eq(getattr(taken",
            ),
            Fault("not cleared", LaneRow, r"Mux\(request\.clear, background, (.*)\)\)", r"\1)"),
            Fault("the colour not cleared", LaneRow, r"Mux\(request\.clear, 0, (.*)\)\)", r"\1)"),
            Fault(
                "leaves where nothing is cleared",
                LaneRow,
                r"Mux\(taken\.clear, (read\.data\.depth), background\)",
                r"\1",
            ),
        ),
    )
]
