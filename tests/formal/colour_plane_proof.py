"""The planes of elements against the contract: the colour unit gives both slopes in full."""

from amaranth.hdl import Cat, Signal

from splatline.contract.plane import SHIFTS
from splatline.contract.presets import PLANE
from splatline.rtl.front import colour
from splatline.rtl.front.colour import ColourUnit
from splatline.rtl.layouts import PlaneLayout
from tests.formal.properties import OneWord, Properties
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]

NINE = PLANE.replace(name="plane-nine", channel_bits=3, coefficient_bits=6, colour_shift=10)
"""``plane`` with the colours of ``paper``, whose table has one memory."""


class ColourProperties(Properties):
    """The plane beside an element: its slopes, and its changes from the word and line before."""

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the colour unit, and the element that it took last."""
        config = self.config
        self.memories = OneWord(Signal(1), apart=False)
        dut = ColourUnit(config)
        self.add(m, dut)
        self.free(m, dut)
        element = dut.i.payload
        beside = element.line_modulo_4 == element.top[:2]
        self.given(m, "beside", ~dut.i.valid | element.end | beside)
        taken = Signal(element.shape())
        with m.If(dut.i.valid & dut.i.ready):
            m.d.sync += taken.eq(element)
        layout = PlaneLayout(config)
        wanted = Signal(layout)
        for number, shift in enumerate(SHIFTS):
            with m.If(taken.scale == number):
                m.d.comb += [
                    wanted.across.eq(taken.slope_x << shift),
                    wanted.down.eq(taken.slope_y << shift),
                ]
        a, b = wanted.across, wanted.down
        m.d.comb += [
            wanted.before.eq(a * taken.x[: config.pixel_bits]),
            wanted.above.eq(b * taken.top[:2]),
        ]
        given = dut.o.payload.plane
        offered = dut.o.valid & ~dut.o.payload.end
        for name in layout.members:
            self.always(m, name, ~offered | (given[name] == wanted[name]))
        # What makes the induction close: the element that is offered is the one taken last.
        same = Cat(dut.o.payload[name] == taken[name] for name in ("x", "top", "end")).all()
        self.lemma(m, "same", ~dut.o.valid | same)


PROOFS = [
    Proof(
        name="colour unit: planes",
        shows="a plane has both slopes in full, and its changes from the word and line before",
        build=lambda: ColourProperties(NINE),
        depth=2,
        endless=True,
        faults=(
            Fault("a shift", colour, r"one\.eq\(1 << shift\)", "one.eq(1)", "plane_of"),
            Fault("another column", colour, r"x\[: config\.pixel_bits\] << shift",
                  "x[: config.pixel_bits]", "plane_of"),
            Fault("another line", colour, r"line_modulo_4 <<", "line_modulo_4[:1] <<", "plane_of"),
            Fault("slopes exchanged", colour, r"down\.eq\(element\.slope_y",
                  "down.eq(element.slope_x", "plane_of"),
        ),
    ),
]  # fmt: skip
