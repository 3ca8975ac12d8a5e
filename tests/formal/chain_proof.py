"""A chain of engines never locks up: once nothing stalls any more, beats come out of it.

That is liveness as a safety property. Stalls are whatever they are, for as long as they like; from
the cycle on in which all of them cease, for ever, a beat must come in every few cycles.
"""

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from lane_window_proof import Narrow
from properties import OneWord, Properties, any_value, parts
from prove import Fault, Proof

from splatline.rtl.chain import Chain
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout
from splatline.rtl.merger import Merger

__all__ = ["PROOFS"]

LITTLE = Narrow(lanes=True, x_bits=2, pixels_per_word=2, line_bits=1, depth_bits=1, channel_bits=1)
"""Two words a line and two lines: what a merger compares, and no more."""


COUNT = 4
"""Bits of the counts of ends: more than can be between any two parts of the chain."""


class AnyEngine(wiring.Component):
    """Takes words and gives beats as an engine may, whatever it draws and however long it takes.

    Between frames it takes a word, which begins a frame, unless a table write was offered before;
    and table writes, once no beat is left. In a frame a word that it takes makes a beat, any beat,
    in any order, that waits on ``raster``; with the end beat the frame is complete. While a beat
    waits it takes no other word of that frame. It stalls as it likes, but not when all is calm.
    """

    def __init__(self, config, calm):
        self.config = config
        self.calm = calm
        self.begins = Signal()
        self.gives_end = Signal()
        self.gives_more = Signal()
        beats = stream.Signature(RasterLayout(config))
        super().__init__(
            {
                "codewords": In(stream.Signature(CodeWordLayout(config))),
                "tables": In(stream.Signature(TableWriteLayout(config))),
                "initial": In(beats),
                "raster": Out(beats),
                "in_frame": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the engine."""
        m = Module()
        is_open, offered, goes, taken = self.in_frame, Signal(), Signal(), Signal()
        may_begin, waited = Signal(), Signal()
        beat, drawn = (Signal(RasterLayout(self.config), name=name) for name in ("beat", "drawn"))
        m.d.comb += [
            drawn.eq(any_value(m, len(Value.cast(drawn)), "any_beat")),
            goes.eq(self.calm | any_value(m, 1, "any_goes")),
            self.tables.ready.eq(~is_open & ~offered),
            may_begin.eq(~self.tables.valid | waited),
            self.codewords.ready.eq(goes & Mux(is_open, ~offered | self.raster.ready, may_begin)),
            taken.eq(self.codewords.valid & self.codewords.ready),
            self.raster.valid.eq(offered),
            self.raster.payload.eq(beat),
            self.begins.eq(taken & ~is_open),
            self.gives_end.eq(offered & beat.end),
            self.gives_more.eq(offered & ~beat.end),
        ]
        m.d.sync += waited.eq(self.codewords.valid & ~self.codewords.ready & ~is_open & may_begin)
        with m.If(~offered | self.raster.ready):
            m.d.sync += [offered.eq(taken & is_open), beat.eq(drawn)]
        with m.If(taken):
            m.d.sync += is_open.eq(~is_open | ~drawn.end)
        return m


class Contents:
    """The ends that entered a queue of two beats and one more, that left it, and that are inside.

    Attributes
    ----------
    entered, left
        How many, modulo ``2 ** COUNT``.
    """

    def __init__(self, properties, m, name, fifo, memory, words):
        (read,), (write,) = memory.read_ports, memory.write_ports
        self.entered, self.left = Signal(COUNT), Signal(COUNT)
        inside = Signal(2)
        m.d.comb += inside.eq(fifo.level - fifo.r_rdy)
        m.d.sync += [
            self.entered.eq(self.entered + (fifo.w_en & fifo.w_rdy & fifo.w_data[-1])),
            self.left.eq(self.left + (fifo.r_en & fifo.r_rdy & fifo.r_data[-1])),
        ]
        ends = fifo.r_rdy & fifo.r_data[-1]
        for n in range(len(words)):
            word = Mux((read.addr + n)[0], words[1], words[0])
            ends = ends + ((inside > n) & word[-1])
        properties.lemma(m, f"{name}_level", inside <= len(words))
        properties.lemma(m, f"{name}_pointers", (write.addr - read.addr)[0] == inside[0])
        properties.lemma(m, f"{name}_ends", (self.left + ends)[:COUNT] == self.entered)


class ChainProperties(Properties):
    """The chain as it is, but for its engines. From some cycle on, all is calm.

    Parameters
    ----------
    engines
        How many.
    most
        Cycles without a beat, at most, from then on, while there are words.
    """

    def __init__(self, engines, most):
        self.engines = engines
        self.most = most

    def describe(self, m):
        """Add the chain and its properties."""
        calm, was_calm = Signal(), Signal()
        m.d.comb += calm.eq(was_calm | any_value(m, 1, "calms"))
        m.d.sync += was_calm.eq(calm)

        engines = []

        def place(kind, make):
            if kind in ("first", "engine"):
                engines.append(AnyEngine(LITTLE, calm))
                return engines[-1]
            return make()

        self.memories = OneWord(Signal(0), styles=(None,))
        dut = Chain(LITTLE, self.engines, queue=2, place=place)
        fragment = self.add(m, dut)
        self.free(m, dut)
        for n in range(self.engines):
            valid = getattr(dut, f"codewords_{n}").valid
            self.given(m, f"words_{n}", valid | ~calm)
        self.given(m, "sink", dut.raster.ready | ~calm)
        # A table write that waits is still to be taken; no other one follows it.
        waiting = Signal()
        m.d.sync += waiting.eq(dut.tables.valid & ~dut.tables.ready)
        late = calm & was_calm & dut.tables.valid
        self.given(m, "tables", Mux(waiting, dut.tables.valid, ~late))

        silent = Signal(range(self.most + 2))
        m.d.sync += silent.eq(Mux(calm & ~dut.raster.valid, silent + 1, 0))
        self.always(m, "goes_on", silent <= self.most)
        self.always(m, "raster", self.steady(m, dut.raster, "raster"))
        self._close(m, dut, engines, fragment)

    def _close(self, m, dut, engines, fragment):
        """Say what makes the induction close: every end is somewhere, as often as it was begun."""
        fifos = [
            Contents(self, m, f"fifo_{n}", *inside)
            for n, inside in enumerate(
                zip(
                    parts(fragment, SyncFIFOBuffered),
                    parts(fragment, Memory),
                    self.memories.words,
                    strict=True,
                )
            )
        ]
        # A queue for each engine, and but for the first one's a merger's behind it.
        queues, mergers = fifos[:1] + fifos[1::2], fifos[2::2]
        rounds = Signal(COUNT)  # frames that all have begun
        ahead = dut.ahead
        begins = Cat(engine.begins for engine in engines)
        m.d.sync += rounds.eq(rounds + (ahead | begins).all())
        self.lemma(m, "ahead", ~ahead.all())
        for n, (engine, queue) in enumerate(zip(engines, queues, strict=True)):
            ended = (queue.entered + engine.gives_end + engine.in_frame)[:COUNT]
            self.lemma(m, f"in_frame_{n}", engine.in_frame | ~engine.gives_more)
            self.lemma(m, f"begun_{n}", ended == (rounds + ahead[n])[:COUNT])
        for n, (before, own, after) in enumerate(
            zip(queues[:1] + mergers, queues[1:], mergers, strict=False)
        ):
            same = (before.left == own.left) & (own.left == after.entered)
            self.lemma(m, f"merged_{n}", same)


SEEN = Fault(
    "a register that lemmas look at", Chain, r"ahead = ", "ahead = self.ahead = ", "_frames"
)

PROOFS = [
    Proof(
        name=f"chain: {engines} engines",
        shows=f"once nothing stalls any more, {most} cycles without a beat are the most",
        build=lambda engines=engines, most=most: ChainProperties(engines, most),
        depth=most + 3,
        endless=True,
        changes=(SEEN,),
        fault_depth=28,
        fault_engine="abc bmc3",
        slow=engines > 2,
        faults=(
            Fault("none begins again", Chain, r"ahead\.eq\(0\)", "ahead.eq(ahead)", "_frames"),
            Fault(
                "shown too early", Chain, r"tables\.valid & between\)", "tables.valid)", "_frames"
            ),
            Fault("an end is left", Merger, r"before\.valid & ~first", "before.valid & second"),
        ),
    )
    for engines, most in ((2, 7), (4, 11))
]
