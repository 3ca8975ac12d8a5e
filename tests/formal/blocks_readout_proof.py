"""The readout of blocks asks for no more beats than its fifo has room for."""

from amaranth.hdl import Cat, Module, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.rtl.blocks.readout import DEPTH, BlockReadout
from splatline.rtl.layouts import RasterLayout
from tests.formal.properties import SWIFT_NINE, Properties, any_value, parts
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS", "Counting"]


MORE = 5
"""Beats above half of the fifo that may be on their way before it is known to be half full."""


class Counting(wiring.Component):
    """In place of the fifo: it knows how many beats it has, and gives any.

    Its latency is whatever it likes.
    """

    def __init__(self, config, depth):
        self.depth = depth
        beats = stream.Signature(RasterLayout(config))
        super().__init__({"i": In(beats), "o": Out(beats), "level": Out(range(2 * depth))})

    def elaborate(self, platform):
        """Build it."""
        m = Module()
        level = self.level
        m.d.comb += [
            self.i.ready.eq(level < self.depth),
            self.o.valid.eq((level != 0) & any_value(m, 1, "any_valid")),
            Value.cast(self.o.payload).eq(
                any_value(m, len(Value.cast(self.o.payload)), "any_beat")
            ),
        ]
        m.d.sync += level.eq(level + self.i.valid - (self.o.valid & self.o.ready))
        return m


class BlockReadoutProperties(Properties):
    """How many beats are on their way, from their request to where they leave the fifo.

    Parameters
    ----------
    places
        Of the fifo.
    """

    def __init__(self, places):
        self.places = places

    def describe(self, m):
        """Add the readout and its properties."""
        dut = BlockReadout(SWIFT_NINE)
        fragment = self.add(m, dut)
        (fifo,) = parts(fragment, Counting)
        self.free(m, dut)
        self.given(m, "asks", ~dut.flush | (dut.room & ~dut.end))
        coming = Signal(3)  # requests of the last cycles
        m.d.sync += coming.eq(Cat(dut.flush, coming))
        self.always(m, "room", ~fifo.i.valid | fifo.i.ready)
        self.always(m, "comes", fifo.i.valid == (coming[-1] | dut.finished))
        self.always(m, "finished", ~dut.finished | (dut.end & (coming == 0)))
        most = self.places // 2 + MORE
        self.lemma(m, "most", fifo.level + sum(coming) + dut.finished <= most)


OURS = '__import__("importlib").import_module("tests.formal.blocks_readout_proof")'


def changes(places):
    """Return what is changed: the fifo, and how many places it has."""
    return (
        Fault(
            "counted alone",
            BlockReadout,
            r"Fifo\(config, DEPTH\)",
            f"{OURS}.Counting(config, DEPTH)",
        ),
        Fault("short", BlockReadout, r"m = Module\(\)", f"m = Module(); DEPTH = {places}"),
    )


BEHIND = Fault("over before its beats", BlockReadout, r" & ~valid\.any\(\)", "")

PROOFS = [
    Proof(
        name=f"blocks: readout, {places} beats",
        shows="no more beats are asked for than the fifo holds, and a frame ends behind them",
        build=lambda places=places: BlockReadoutProperties(places),
        depth=depth,
        endless=True,
        changes=changes(places),
        faults=(BEHIND, *faults),
    )
    for places, depth, faults in (
        (DEPTH, 5, ()),
        (
            12,
            24,
            (
                Fault("one too many", BlockReadout, r"DEPTH // 2", "DEPTH - 3"),
                Fault("ends without room", BlockReadout, r"self\.end & self\.room", "self.end"),
            ),
        ),
    )
]
