"""A chain of engines never locks up: once nothing stalls any more, beats come out of it.

That is liveness as a safety property. Stalls are whatever they are, for as long as they like; from
the cycle on in which all of them cease, for ever, a beat must come in every few cycles.
"""

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from splatline.rtl.chain.chain import Chain
from splatline.rtl.chain.merger import Merger
from splatline.rtl.layouts import CodeWordLayout, RasterLayout, TableWriteLayout
from tests.formal.properties import OneWord, Properties, any_value, parts
from tests.formal.prove import Fault, Proof
from tests.formal.window_properties import Narrow

__all__ = ["PROOFS"]

LITTLE = Narrow(x_bits=2, pixels_per_word=2, line_bits=1, depth_bits=1, channel_bits=1)
"""Two words a line and two lines: what a merger compares, and no more."""


COUNT = 4
"""Bits of the counts of ends: more than can be between any two parts of the chain."""


class AnyEngine(wiring.Component):
    """Takes words and gives beats as an engine may, whatever it draws and however long it takes.

    A word that it takes behind an end word begins a frame, and any word may be an end word. Beats
    are any, in any order, and as many as it likes, but a frame's end beat comes behind its end
    word, and before any beat of the next frame. Of two frames at most the end beat is still to
    come. Table writes are taken when there is none and no end beat waits; one that is
    offered keeps the next frame from beginning, unless a word of that was offered before.

    It stalls as it likes. When all is calm it begins a frame where none is left, and gives beats
    while there is one.
    """

    def __init__(self, config, calm):
        self.config = config
        self.calm = calm
        self.begins = Signal()
        self.frames = Signal(2)  # of which the end beat is still to be given
        self.offered, self.offers_end = Signal(), Signal()
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
        in_frame, frames, offered = self.in_frame, self.frames, self.offered
        taken, ends, may_begin, waited = Signal(), Signal(), Signal(), Signal()
        moves, gives, last = Signal(), Signal(), Signal()
        beat, drawn = (Signal(RasterLayout(self.config), name=name) for name in ("beat", "drawn"))
        m.d.comb += [
            drawn.eq(any_value(m, len(Value.cast(drawn)), "any_beat")),
            ends.eq(any_value(m, 1, "any_ends")),
            may_begin.eq((frames != 2) & (~self.tables.valid | waited)),
            self.codewords.ready.eq(
                Mux(
                    in_frame,
                    any_value(m, 1, "any_takes"),
                    may_begin & (any_value(m, 1, "any_begins") | (self.calm & (frames == 0))),
                )
            ),
            taken.eq(self.codewords.valid & self.codewords.ready),
            self.begins.eq(taken & ~in_frame),
            self.tables.ready.eq((frames == 0) & ~self.offers_end),
            moves.eq(~offered | self.raster.ready),
            gives.eq(moves & (frames != 0) & (self.calm | any_value(m, 1, "any_gives"))),
            last.eq(gives & drawn.end & ((frames == 2) | ~in_frame)),
            self.raster.valid.eq(offered),
            self.raster.payload.eq(beat),
            self.offers_end.eq(offered & beat.end),
        ]
        m.d.sync += [
            waited.eq(self.codewords.valid & ~self.codewords.ready & ~in_frame & may_begin),
            frames.eq(frames + self.begins - last),
        ]
        with m.If(taken):
            m.d.sync += in_frame.eq(~ends)
        with m.If(moves):
            m.d.sync += [offered.eq(gives), beat.eq(drawn), beat.end.eq(last)]
        return m


class Contents:
    """The ends that entered a fifo of two beats and one more, that left it, and that are inside.

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
        # A table is written in all engines at once: none begins a frame with another one.
        for n, engine in enumerate(engines):
            write = engine.tables.payload
            writes = engine.tables.valid & engine.tables.ready & ~write.address.all()
            taken = dut.tables.valid & dut.tables.ready
            same = write.as_value() == dut.tables.payload.as_value()
            self.always(m, f"table_{n}", ~writes | (taken & same))
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
        # A fifo for each engine, and but for the first one's a merger's behind it.
        queues, mergers = fifos[:1] + fifos[1::2], fifos[2::2]
        rounds = Signal(COUNT)  # frames that all have begun
        ahead = dut.ahead
        begins = Cat(engine.begins for engine in engines)
        m.d.sync += rounds.eq(rounds + (ahead | begins).all())
        self.lemma(m, "ahead", ~ahead.all())
        for n, (engine, queue) in enumerate(zip(engines, queues, strict=True)):
            ended = (queue.entered + engine.offers_end + engine.frames)[:COUNT]
            more = engine.offered & ~engine.offers_end
            self.lemma(m, f"frames_{n}", (engine.frames != 3) & (engine.frames >= engine.in_frame))
            self.lemma(m, f"more_{n}", (engine.frames != 0) | ~more)
            self.lemma(m, f"begun_{n}", ended == (rounds + ahead[n])[:COUNT])
        for n, (before, own, after) in enumerate(
            zip(queues[:1] + mergers, queues[1:], mergers, strict=False)
        ):
            same = (before.left == own.left) & (own.left == after.entered)
            self.lemma(m, f"merged_{n}", same)


SEEN = Fault(
    "a register that lemmas look at", Chain, r"ahead = ", "ahead = self.ahead = ", "_frames"
)

FAULTS = (
    Fault("none begins again", Chain, r"ahead\.eq\(0\)", "ahead.eq(ahead)", "_frames"),
    Fault("shown too early", Chain, r"tables\.valid & between\)", "tables.valid)", "_frames"),
    Fault("written by one", Chain, r"Mux\(all_idle, (.*), -1\)", r"\1", "_frames"),
    Fault("an end is left", Merger, r"before\.valid & ~first", "before.valid & second"),
)

PROOFS = [
    Proof(
        name=f"chain: {engines} engines",
        shows="a table is written in all engines at once; once nothing stalls any more, "
        f"{most} cycles without a beat are the most",
        build=lambda engines=engines, most=most: ChainProperties(engines, most),
        depth=most + 3,
        endless=True,
        changes=(SEEN,),
        fault_depth=28,
        fault_engine="abc bmc3",
        slow=engines > 2,
        long=engines > 2,
        # All in lines that two engines have as well; one shows that more can fail.
        faults=FAULTS if engines == 2 else FAULTS[-1:],
    )
    for engines, most in ((2, 7), (3, 9))
]
