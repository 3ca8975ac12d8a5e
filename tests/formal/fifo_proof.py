"""A fifo of beats loses none, invents none, and gives them in order."""

from amaranth.hdl import Mux, Signal, Value
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.memory import Memory

from splatline.contract.presets import PAPER
from splatline.rtl.lib.fifo import SHORT, Fifo
from tests.formal.properties import OneWord, Properties, any_constant, any_value, parts
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]


class FifoProperties(Properties):
    """Any one beat, followed from where it comes in to where it goes out.

    The beats before it are counted when it comes; after as many it must be there, unchanged. All
    beats are counted as well, so nothing comes out that did not go in.
    """

    def __init__(self, config, depth):
        self.config = config
        self.depth = depth

    def describe(self, m):
        """Add the fifo and its properties."""
        address = any_constant(m, range(self.depth), "address")
        self.memories = OneWord(address, styles=(None,))
        dut = Fifo(self.config, self.depth)
        fragment = self.add(m, dut)
        self.free(m, dut)
        self.given(m, "i", self.steady(m, dut.i, "i"))
        self.always(m, "o", self.steady(m, dut.o, "o"))
        taken, given = dut.i.valid & dut.i.ready, dut.o.valid & dut.o.ready

        # How many there are.
        count = Signal(range(self.depth + 3))
        m.d.sync += count.eq(count + taken - given)
        self.always(m, "not_invented", ~dut.o.valid | (count != 0))
        self.always(m, "room", dut.i.ready | (count >= self.depth))
        waited = Signal(2)
        with m.If((count == 0) | dut.o.valid):
            m.d.sync += waited.eq(0)
        with m.Else():
            m.d.sync += waited.eq(waited + 1)
        self.always(m, "comes", waited < 2 + (self.depth > SHORT))

        # The beat that is followed: one that is written at the word that is kept.
        (memory,), (fifo,) = parts(fragment, Memory), parts(fragment, SyncFIFOBuffered)
        (read,), (write,) = memory.read_ports, memory.write_ports
        beat = Signal(len(Value.cast(dut.i.payload)), reset_less=True)
        ahead = Signal.like(count)
        follows, begins = Signal(), Signal()
        m.d.comb += begins.eq(
            ~follows & any_value(m, 1, "begins") & taken & (write.addr == address)
        )
        with m.If(begins):
            m.d.sync += [beat.eq(dut.i.payload), ahead.eq(count - given), follows.eq(1)]
        with m.Elif(follows & given):
            m.d.sync += [ahead.eq(ahead - 1), follows.eq(ahead != 0)]
        mine = follows & dut.o.valid & (ahead == 0)
        self.always(m, "unchanged", ~mine | (Value.cast(dut.o.payload) == beat))

        # What makes the induction close: where the beats are, and where this one is.
        held = self.depth > SHORT and dut.o.valid  # in the register behind a long fifo
        outside = Signal(2)  # beats that have left the memory
        inside = Signal.like(count)
        place = Signal.like(count)  # of the beat among those in the memory
        distance = Signal(range(self.depth))
        used = Signal(range(self.depth))
        m.d.comb += [
            outside.eq(held + fifo.r_rdy),
            inside.eq(count - outside),
            place.eq(ahead - outside),
            distance.eq(address - read.addr),
            used.eq(write.addr - read.addr),
        ]
        ((word,),) = self.memories.words
        self.lemma(m, "counted", (fifo.level + held == count) & (outside <= count))
        self.lemma(m, "pointers", (used == inside[: len(used)]) & (inside <= self.depth))
        self.lemma(m, "ahead", ~follows | (ahead < count))
        self.lemma(
            m,
            "in_memory",
            ~follows | (ahead < outside) | ((distance == place) & (Value.cast(word) == beat)),
        )
        first = Mux(fifo.r_rdy & ~(held & (ahead == 0)), fifo.r_data, dut.o.payload)
        self.lemma(m, "on_its_way", ~follows | (ahead >= outside) | (first == beat))


PROOFS = [
    Proof(
        name=f"fifo: order, {depth} beats",
        shows="every beat comes out, once, in order and unchanged, and none waits for another",
        build=lambda depth=depth: FifoProperties(PAPER, depth),
        depth=3,
        endless=True,
        faults=(
            Fault("locks up", Fifo, r"ready\.eq\(fifo\.w_rdy\)", "ready.eq(fifo.r_rdy)"),
            *faults,
        ),
    )
    for depth, faults in (
        (
            2,
            (
                Fault("taken when full", Fifo, r"ready\.eq\(fifo\.w_rdy\)", "ready.eq(1)"),
                Fault("not held", Fifo, r"r_en\.eq\(self\.o\.ready\)", "r_en.eq(1)"),
            ),
        ),
        (
            256,
            (
                Fault("not held", Fifo, r"~valid \| self\.o\.ready", "1"),
                Fault("invented", Fifo, r"\[valid\.eq\(fifo\.r_rdy\)", "[valid.eq(1)"),
            ),
        ),
    )
]
