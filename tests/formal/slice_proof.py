"""The registers that cut AXI streams lose nothing, invent nothing, and keep the order."""

from amaranth.hdl import Mux, Signal

from splatline.rtl.bus.axi_stream import HalfSlice, RegisterSlice, ReverseSlice
from tests.formal.properties import Properties, any_value
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]

WIDTH = 72
"""Bits of a payload."""


class SliceProperties(Properties):
    """Any one payload, followed from where it comes in to where it goes out; all are counted.

    Parameters
    ----------
    kind
        The slice.
    room
        How many payloads it holds.
    passes
        Whether a payload passes in the cycle in which it comes.
    """

    def __init__(self, kind, room, passes=False):
        self.kind = kind
        self.room = room
        self.passes = passes

    def describe(self, m):
        """Add the slice and its properties."""
        dut = self.kind(WIDTH)
        self.add(m, dut)
        self.free(m, dut)
        taken, given = dut.i.valid & dut.i.ready, dut.o.valid & dut.o.ready
        count = Signal(2)
        m.d.sync += count.eq(count + taken - given)
        passing = (count == 0) & dut.i.valid if self.passes else 0
        self.always(m, "offered", dut.o.valid == ((count != 0) | passing))
        if self.passes:
            self.always(m, "passing", ~passing | (dut.o.payload == dut.i.payload))
        self.always(m, "room", dut.i.ready == (count < self.room))

        payload = Signal(WIDTH, reset_less=True)
        ahead = Signal(2)
        follows, begins = Signal(), Signal()
        gone = given & (count == 0)  # it passed
        m.d.comb += begins.eq(~follows & any_value(m, 1, "begins") & taken & ~gone)
        with m.If(begins):
            m.d.sync += [payload.eq(dut.i.payload), ahead.eq(count - given), follows.eq(1)]
        with m.Elif(follows & given):
            m.d.sync += [ahead.eq(ahead - 1), follows.eq(ahead != 0)]
        mine = follows & (ahead == 0)
        self.always(m, "unchanged", ~mine | (dut.o.valid & (dut.o.payload == payload)))
        waiting = dut.waiting if self.room > 1 else payload
        kept = Mux(ahead == 0, dut.o.payload, waiting) == payload
        self.lemma(m, "kept", ~follows | ((ahead < count) & kept))
        self.lemma(m, "counted", count <= self.room)


SEEN = Fault(
    "a register that a lemma looks at", RegisterSlice, r"waiting = ", "waiting = self.waiting = "
)

PROOFS = [
    Proof(
        name="register slice: order",
        shows="every payload comes out, once, in order and unchanged",
        build=lambda: SliceProperties(RegisterSlice, 2),
        depth=3,
        endless=True,
        changes=(SEEN,),
        faults=(
            Fault("lost", RegisterSlice, r"spare\.eq\(1\)", "spare.eq(0)"),
            Fault("overwritten", RegisterSlice, r"If\(~spare\)", "If(1)"),
        ),
    ),
    Proof(
        name="half slice: order",
        shows="every payload comes out, once, in order and unchanged",
        build=lambda: SliceProperties(HalfSlice, 1),
        depth=3,
        endless=True,
        faults=(Fault("lost", HalfSlice, r"valid\.eq\(~self\.o\.ready\)", "valid.eq(0)"),),
    ),
    Proof(
        name="reverse slice: order",
        shows="every payload comes out, once, in order and unchanged",
        build=lambda: SliceProperties(ReverseSlice, 1, passes=True),
        depth=3,
        endless=True,
        faults=(
            Fault("lost", ReverseSlice, r"full\.eq\(", "full.eq(0 & "),
            Fault("overwritten", ReverseSlice, r"If\(~full\)", "If(1)"),
        ),
    ),
]
