"""A bank with colours in planes keeps the nearest pixels, all of their planes with them."""

from amaranth.hdl import Cat, Mux, Signal
from amaranth.lib import data
from properties import OneWord, Properties, any_constant
from prove import Fault, Proof

from splatline.rtl.bank import BankRequestLayout
from splatline.rtl.bank_layout import bank_address_bits
from splatline.rtl.planar_bank import PaintLayout, PlanarBank
from splatline.rtl.presets import PRESETS

__all__ = ["PROOFS"]


class PlanarBankProperties(Properties):
    """Any pixel of any word, followed from the first time that it is cleared or loaded.

    An access has three stages: its request has been taken (depth and plane 0 stand on ``old``), the
    further planes are read, they stand on ``old`` and are written. A pixel of the background may
    have any colour. So may what is given up by a clear before anything was drawn or loaded: then
    clears need not heed what is drawn and read.

    A load has no stages. It comes in two halves, the further planes behind the other one, and
    between them nobody asks for that word.
    """

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the bank and its properties."""
        config = self.config
        self.address = address = any_constant(m, bank_address_bits(config), "address")
        self.number = any_constant(m, config.pixel_bits, "number")
        self.memories = OneWord(address)
        self.dut = dut = PlanarBank(config)
        self.add(m, dut)
        self.free(m, dut)
        self.near = data.StructLayout({"depth": config.depth_bits, "colour": config.plane_bits})
        # Plane 2 lies where depths lie; without one those bits are left out.
        self.far = data.StructLayout(
            {
                "depth": config.plane_bits if config.colour_planes == 3 else 0,
                "colour": config.plane_bits,
            }
        )

        # What was requested last; what is drawn stays while all stands still.
        asked = Signal(BankRequestLayout(config))
        before = Signal(PaintLayout(config))
        stood, begun = Signal(), Signal()
        with m.If(dut.enable):
            m.d.sync += [
                asked.eq(dut.request),
                begun.eq(begun | dut.request.draw | dut.request.load),
            ]
        m.d.sync += [before.eq(dut.new), stood.eq(~dut.enable)]
        request, new = dut.request, dut.new
        wishes = Cat(request.draw, request.clear, request.load)
        self.given(m, "one_of_three", (wishes & (wishes - 1)) == 0)
        same = (asked.draw | asked.clear) & (request.address == asked.address)
        waits = (dut.busy | same) & dut.enable
        urgent = request.draw | request.load | (request.clear & begun)
        self.given(m, "waits", ~waits | ~urgent)
        self.given(m, "new_steady", ~stood | (before == new))
        early, late = (self._pixel(m, new[name], name) for name in ("early", "late"))
        loaded = self._pixel(m, dut.loaded, "loaded")
        depth = Signal(config.depth_bits)
        m.d.comb += depth.eq(early.depth)
        wanted = Signal()  # this word is
        fills, completes = Signal(), Signal()  # loads its depths and plane 0, and the others
        half = Signal()  # the others are still to come
        m.d.comb += [
            wanted.eq(wishes.any() & (request.address == address) & dut.enable),
            fills.eq(wanted & request.load & ~request.further),
            completes.eq(wanted & request.load & request.further),
        ]
        m.d.sync += half.eq((half | fills) & ~completes)
        self.given(m, "in_halves", ~wanted | (completes == half))

        # The definition: depth and plane 0, then the planes that follow two steps later.
        background = config.background_depth
        known, mine, covered, passes = (Signal() for _ in range(4))
        pixel, after = Signal(self.near), Signal(self.near)
        m.d.comb += [
            mine.eq(asked.address == address),
            covered.eq(asked.mask.bit_select(self.number, 1)),
            passes.eq(mine & asked.draw & covered & (depth < pixel.depth)),
            after.eq(pixel),
        ]
        with m.If(passes):
            m.d.comb += [after.depth.eq(depth), after.colour.eq(early.colour)]
        with m.If(mine & asked.clear):
            m.d.comb += after.depth.eq(background)
        planes, planes_after = Signal(self.far), Signal(self.far)
        lit, lit_after = Signal(), Signal()  # it has planes
        passed, gone, cleared = Signal(2), Signal(2), Signal(2)  # in the two stages that follow
        m.d.comb += [planes_after.eq(planes), lit_after.eq((lit | passed[1]) & ~cleared[1])]
        with m.If(passed[1]):
            m.d.comb += [planes_after.depth.eq(late.depth), planes_after.colour.eq(late.colour)]
        clears = known & mine & asked.clear
        with m.If(dut.enable):
            m.d.sync += [
                pixel.eq(after),
                known.eq(known | (mine & asked.clear)),
                planes.eq(planes_after),
                lit.eq(lit_after),
                passed.eq((known & passes) | (passed << 1)),
                cleared.eq((mine & asked.clear) | (cleared << 1)),
                gone.eq((clears & (pixel.depth != background)) | (gone << 1)),
            ]
        with m.If(fills):
            m.d.sync += [pixel.eq(self._near(m, loaded, "loaded")), known.eq(1), lit.eq(0)]
        with m.If(completes):
            m.d.sync += [
                planes.eq(self._far(m, loaded, "loaded")),
                lit.eq(known & (pixel.depth != background)),
            ]

        def same(one, other):
            """A pixel of the background may have any colour."""
            near = self.near
            return (near(one).depth == near(other).depth) & (
                (near(one).depth == background) | (near(one).colour == near(other).colour)
            )

        old = self._pixel(m, dut.old, "old")
        old_near, old_far = self._near(m, old, "old"), self._far(m, old, "old")
        used = known & mine & (asked.draw | asked.clear)
        heeded = asked.draw | begun  # a clear that heeded nothing reads as anything
        self.always(m, "read", ~(used & heeded) | same(old_near, pixel))
        self.always(m, "planes", ~gone[1] | (old_far == planes))
        wrote = dut.drawn_address == asked.address
        draws = asked.draw | asked.load
        self.always(m, "drawn", (dut.drawn == draws) & (~dut.drawn | wrote))

        # What makes the induction close: the memories have it, or already what comes of it.
        depths, colours = self.memories.words
        kept = self._pixel(m, self._word(m, depths[0], colours[0], "kept"), "kept")
        stays = self._near(m, kept, "kept")
        self.lemma(m, "kept", ~known | same(stays, Mux(used & stood, after, pixel)))
        far = self._pixel(m, self._word(m, depths[-1], colours[-1], "far"), "far")
        due = Mux(passed[1] & stood, planes_after, planes)
        lives = known & ((lit & ~cleared[1]) | (passed[1] & stood))
        self.lemma(m, "kept_planes", ~lives | (self._far(m, far, "far").as_value() == due))
        self.lemma(
            m,
            "lit",
            ~known
            | (
                ((lit & ~cleared.any()) | passed.any() | (half & (pixel.depth != background)))
                == (pixel.depth != background)
            ),
        )
        # Accesses to this pixel: which stage has which, and that none meets another.
        self.lemma(m, "gone", ((gone & ~cleared) == 0) & (~gone.any() | (lit & known)))
        self.lemma(m, "gone_once", ~(gone[0] & cleared[1]))
        self.lemma(m, "one_access", ~(asked.draw & asked.clear))
        self.lemma(m, "no_draw_behind_a_clear", ~(mine & asked.draw & cleared[0]))
        self.lemma(m, "one", ~passed.any() | (known & ~cleared.any()))
        for stage, name in enumerate(("reading", "writing")):
            late_access = getattr(dut, name)
            here = late_access.address == address
            writes = here & late_access.write & late_access.mask.bit_select(self.number, 1)
            self.lemma(m, f"{name}_passed", ~known | (passed[stage] == writes))
            self.lemma(m, f"{name}_gone", ~gone[stage] | (here & late_access.read))
            self.lemma(m, f"{name}_both", ~late_access.write | late_access.read)
            self.lemma(m, f"{name}_half", ~(half & here & late_access.write))
        accessed = (mine & (asked.draw | asked.clear)) | passed.any() | cleared[0]
        self.lemma(m, "half", ~half | (known & ~lit & ~accessed))
        # Accesses to any word, as far as they are kept apart.
        writes = asked.draw | dut.reading.write | dut.writing.write
        self.lemma(m, "begun", begun | ~(writes | lit))
        self.lemma(m, "known", known | ~lit)
        access = dut.writing
        idle = ~(asked.draw | asked.clear)
        self.lemma(m, "port", ~begun | ~access.read | idle)
        follows = ~idle & dut.reading.read & (asked.address == dut.reading.address)
        self.lemma(m, "neighbours", ~(begun & follows))
        follows = dut.reading.read & access.read & (dut.reading.address == access.address)
        self.lemma(m, "neighbours_late", ~(begun & follows))
        touched = known & lit & access.read & (access.address == address)
        self.lemma(m, "old_planes", ~touched | (old_far == planes))

    def _pixel(self, m, word, name):
        """Return the pixel that is followed, out of a word's planes."""
        pixel = Signal(
            data.StructLayout({"depth": word.depth[0].shape(), "colour": self.config.plane_bits}),
            name=f"{name}_pixel",
        )
        m.d.comb += [
            pixel.depth.eq(word.depth[self.number]),
            pixel.colour.eq(word.colour[self.number]),
        ]
        return pixel

    def _word(self, m, depths, colours, name):
        """Return what the memories keep as a word's planes."""
        word = Signal.like(self.dut.old, name=f"{name}_word")
        m.d.comb += [word.depth.as_value().eq(depths), word.colour.as_value().eq(colours)]
        return word

    def _near(self, m, pixel, name):
        """Return its depth and plane 0."""
        near = Signal(self.near, name=f"{name}_near")
        m.d.comb += [near.depth.eq(pixel.depth), near.colour.eq(pixel.colour)]
        return near

    def _far(self, m, pixel, name):
        """Return its further planes."""
        far = Signal(self.far, name=f"{name}_far")
        m.d.comb += [far.depth.eq(pixel.depth), far.colour.eq(pixel.colour)]
        return far


SEEN = tuple(
    Fault(f"lemmas look at {name}", PlanarBank, rf"{name} = ", f"{name} = self.{name} = ")
    for name in ("reading", "writing")
)

FAULTS = (
    Fault("planes of all pixels", PlanarBank, r"writing\.mask, passes", "-1, passes"),
    Fault("planes not written", PlanarBank, r"clear \| late_write", "clear"),
    Fault(
        "further planes loaded over the others",
        PlanarBank,
        r"late_read \| \(further & late\[name\]\)",
        "late_read",
    ),
    Fault(
        "no depth test",
        PlanarBank,
        r"Cat\((self\.new\.early\.depth\[pixel\].*), 1\)",
        r"Cat(\1 & 0, 1)",
    ),
    Fault("ties drawn", PlanarBank, r"< Cat\(self\.old", "<= Cat(self.old"),
    Fault("the port not kept for planes", PlanarBank, r"busy\.eq\(reading\.read\)", "busy.eq(0)"),
    Fault(
        "planes of the next word",
        PlanarBank,
        r"eq\(taken\.address\),\n(\s+writing)",
        r"eq(self.request.address),\n\1",
    ),
    Fault("planes given up unread", PlanarBank, r"given_up \| drawn", "drawn"),
    Fault("does not stand still", PlanarBank, r"m\.If\(self\.enable\)", "m.If(1)"),
    Fault(
        "loaded while it stands still",
        PlanarBank,
        r"self\.enable & (self\.request\.load & \()",
        r"\1",
    ),
    Fault("a load unmarked", PlanarBank, r" \| taken\.load", ""),
)

PROOFS = [
    Proof(
        name=f"planar bank: pixel, {config.colour_planes} planes",
        shows="a pixel is what was drawn nearest since it was loaded or cleared, in all planes, "
        "with any stalls",
        build=lambda config=config: PlanarBankProperties(config),
        depth=4,
        fault_depth=15,
        fault_engine="abc bmc3",
        slow=config.colour_planes > 2,
        endless=True,
        changes=SEEN,
        # The first three are of the planes; the others lie in the same lines for any number.
        faults=FAULTS if config.colour_planes == 2 else FAULTS[:3],
    )
    for config in (PRESETS["rgb18"], PRESETS["rgb24"])
]
