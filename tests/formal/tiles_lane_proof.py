"""A lane keeps the nearest pixel, whatever follows whatever."""

from amaranth.hdl import Cat, Const, Mux, Signal

from splatline.contract.presets import PAPER, PLANE
from splatline.rtl.layouts import PixelLayout
from splatline.rtl.tiles.lane import Lane, LaneRequestLayout, lane_address_bits
from tests.formal.properties import OneWord, Properties, any_constant
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]


class LaneProperties(Properties):
    """Any one pixel, followed from the first time that it is cleared or loaded."""

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the lane and its properties."""
        config = self.config
        address = any_constant(m, lane_address_bits(config), "address")
        self.memories = OneWord(address)
        dut = Lane(config)
        self.add(m, dut)
        self.free(m, dut)

        # What was requested last; its ``new`` stays while all stands still.
        asked = Signal(LaneRequestLayout(config))
        new = Signal(PixelLayout(config))
        stood = Signal()
        with m.If(dut.enable):
            m.d.sync += asked.eq(dut.request)
        m.d.sync += [new.eq(dut.new), stood.eq(~dut.enable)]
        request = dut.request
        simple = config.memory == "simple"
        load = Const(0) if simple else request.load
        wanted = Cat(request.draw, request.clear, load)
        writing = (asked.draw | asked.clear) & (asked.address == request.address)
        self.given(m, "one_of_three", (wanted & (wanted - 1)) == 0)
        self.given(m, "waits", ~(wanted.any() & writing))
        self.given(m, "new_steady", ~stood | (new == dut.new))
        if config.plane:
            cleared = dut.new.depth == config.background_depth
            self.given(m, "new_cleared", ~asked.clear | cleared)

        # The definition.
        known = Signal()
        pixel = Signal(PixelLayout(config))
        after = Signal(PixelLayout(config))
        background = config.background_depth
        mine = Signal()
        m.d.comb += [mine.eq(asked.address == address), after.eq(pixel)]
        with m.If(mine & asked.draw & (dut.new.depth < pixel.depth)):
            m.d.comb += after.eq(dut.new)
        with m.If(mine & asked.clear):
            m.d.comb += after.eq(dut.new) if simple else after.depth.eq(background)
        with m.If(dut.enable):
            m.d.sync += [pixel.eq(after), known.eq(known | (mine & asked.clear))]
            if not simple:
                with m.If(load & (request.address == address)):
                    m.d.sync += [pixel.eq(dut.loaded), known.eq(1)]

        def same(one, other):
            """A pixel of the background may have any colour."""
            return (one.depth == other.depth) & (
                (one.depth == background) | (one.colour == other.colour)
            )

        used = known & mine & (asked.draw | asked.clear)
        self.always(m, "read", ~used | same(dut.old, pixel))
        # What makes the induction close: the memory has the pixel, or already what comes of it.
        ((kept,),) = self.memories.words
        kept = PixelLayout(config)(kept)
        due = PixelLayout(config)(Mux(used & stood, after, pixel))
        self.lemma(m, "kept", ~known | same(kept, due))


ALWAYS = Fault("cleared where it is further", Lane, r"taken\.draw, taken\.clear", "taken.draw, 0")
"""A clear whose pixel is compared."""

TIES = Fault("ties drawn", Lane, r"new - old if", "new - 1 - old if")
"""The comparison of simple memories."""

FAULTS = (
    Fault("no depth test", Lane, r"en\.eq\(difference\[-1\]", "en.eq(taken.draw | taken.clear"),
    Fault("does not stand still", Lane, r"m\.If\(self\.enable\)", "m.If(1)"),
    Fault("read while it stands still", Lane, r"en\.eq\(self\.enable\)", "en.eq(1)"),
)
"""What any lane must not do."""

LOADS = (
    Fault("ties drawn", Lane, r"old \+ ~new", "old + 1 + ~new"),
    Fault("loaded while it stands still", Lane, r"self\.enable & (self\.request\.load)", r"\1"),
    Fault("loaded too late", Lane, r"load\.addr\.eq\(self\.request", "load.addr.eq(taken"),
    Fault("drawn over while loaded", Lane, r"draw, taken\.clear", "draw, taken.clear | taken.load"),
)
"""Nor one whose other port loads; its comparison is an addition."""


def plan(name, config, *faults):
    """Return a proof of the lane."""
    return Proof(
        name=name,
        shows="a pixel is what was drawn nearest since it was loaded or cleared, with any stalls",
        build=lambda: LaneProperties(config),
        depth=8,
        endless=True,
        faults=(*FAULTS, *faults),
    )


PROOFS = [
    plan(
        "lane: pixel",
        PAPER,
        *LOADS,
        Fault("not cleared", Lane, r" \| taken\.clear\.replicate\(config\.depth_bits\)", ""),
    ),
    plan("lane: planes", PLANE, *LOADS, ALWAYS),
    plan("lane: simple memories", PAPER.with_memory("simple"), TIES, ALWAYS),
]
