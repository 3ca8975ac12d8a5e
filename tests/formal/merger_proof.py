"""A merger makes one picture of two: each beat comes out once, in order, and nothing locks up."""

from amaranth.hdl import Cat, Mux, Signal
from amaranth.lib import data
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.memory import Memory

from splatline.contract.presets import PAPER
from splatline.rtl.chain.merger import ROOM, Merger
from splatline.rtl.layouts import PixelLayout
from splatline.rtl.lib.fifo import Fifo
from tests.formal.properties import OneWord, Properties, any_constant, parts
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS", "Contract", "place_of"]


def place_of(m, beat, name):
    """Return a beat's place in the image, from 1 up; the end of the frame is the largest."""
    place = Signal(len(beat.word) + len(beat.line) + 1, name=f"{name}_place")
    m.d.comb += place.eq(Mux(beat.end, -1, Cat(beat.word, beat.line) + 1))
    return place


class Contract:
    """What a raster keeps to: places rise strictly up to an end beat, then anew.

    Attributes
    ----------
    place
        Of the beat that is on the stream.
    last
        Of the last beat of this frame that was taken; 0 if there was none.
    kept
        Whether the contract is kept in this cycle.
    """

    def __init__(self, m, stream, name):
        self.place = place_of(m, stream.payload, name)
        self.last = Signal(len(self.place), name=f"{name}_last")
        self.taken = Signal(name=f"{name}_taken")
        m.d.comb += self.taken.eq(stream.valid & stream.ready)
        with m.If(self.taken):
            m.d.sync += self.last.eq(Mux(stream.payload.end, 0, self.place))
        self.kept = ~stream.valid | (self.place > self.last)


class MergerProperties(Properties):
    """One pixel of every beat, by its number in the word.

    A cycle in which something is taken makes one beat: what was taken alone, or of two beats of the
    same place the nearer pixel. With places that rise, that is the merged picture: had the two
    beats of a place been taken apart, the place would come twice.
    """

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the merger and its properties."""
        config = self.config
        self.memories = OneWord(Signal(0), styles=(None,))
        self.number = any_constant(m, config.pixel_bits, "number")
        self.dut = dut = Merger(config)
        self.fragment = self.add(m, dut)
        self.free(m, dut)
        streams = {"before": dut.before, "own": dut.own, "o": dut.o}
        rules = {name: Contract(m, stream, name) for name, stream in streams.items()}
        for name in ("before", "own"):
            self.given(m, name, self.steady(m, streams[name], name) & rules[name].kept)
        self.always(m, "o_steady", self.steady(m, dut.o, "o"))
        self.always(m, "o_rises", rules["o"].kept)
        before, own, out = rules.values()

        # The definition: what this cycle takes.
        self.beat = data.StructLayout(
            {"place": len(out.place), "end": 1, "pixel": PixelLayout(config)}
        )
        first, second = self._seen(m, "before", before), self._seen(m, "own", own)
        both = before.taken & own.taken
        nearer = first.pixel.depth <= second.pixel.depth  # of equals the earlier engine's
        joined = Signal(self.beat)
        m.d.comb += joined.eq(Mux(before.taken, first, second))
        with m.If(both):
            m.d.comb += joined.pixel.eq(Mux(nearer, first.pixel, second.pixel))
        self.always(m, "same_place", ~both | (before.place == own.place))
        ends = Signal(2)
        m.d.comb += ends.eq(
            Cat(before.taken & dut.before.payload.end, own.taken & dut.own.payload.end)
        )
        self.always(m, "ends_together", (ends == 0) | (ends == 3))

        # What was taken comes out, and nothing else.
        push = before.taken | own.taken
        queue = [Signal(self.beat, name=f"queue_{n}") for n in range(ROOM + 1)]
        length = Signal(range(ROOM + 3))
        with m.If(out.taken):
            m.d.sync += [queue[n].eq(queue[n + 1]) for n in range(ROOM)]
        for n in range(ROOM + 1):
            with m.If(push & (length - out.taken == n)):
                m.d.sync += queue[n].eq(joined)
        m.d.sync += length.eq(length + push - out.taken)
        shown = self._seen(m, "o", out)
        self.always(m, "room", length <= ROOM + 1)
        self.always(m, "out", ~dut.o.valid | ((length != 0) & self._same(shown, queue[0])))

        # It goes on: with a beat on both sides, or one inside, and room on the way out.
        offered = dut.before.valid & dut.own.valid
        idle = Signal(3)
        m.d.sync += idle.eq(Mux((offered | (length != 0)) & dut.o.ready & ~out.taken, idle + 1, 0))
        self.always(m, "moves", ~(offered & dut.o.ready) | push | out.taken)
        self.always(m, "comes", idle < 3)
        self._close(m, before, own, out, queue, length)

    def _seen(self, m, name, rule):
        """Return what is looked at of a stream's beat."""
        payload = getattr(self.dut, name).payload
        seen = Signal(self.beat, name=f"{name}_seen")
        m.d.comb += [
            seen.place.eq(rule.place),
            seen.end.eq(payload.end),
            seen.pixel.depth.eq(payload.pixels.depth[self.number]),
            seen.pixel.colour.eq(payload.pixels.colour[self.number]),
        ]
        return seen

    def _same(self, one, other):
        """Return whether two beats are the same; of an end nothing else counts."""
        return (one.end & other.end) | (one.as_value() == other.as_value())

    def _close(self, m, before, own, out, queue, length):
        """Say what makes the induction close: where the beats are, and what their places are."""
        (memory,), (fifo,) = parts(self.fragment, Memory), parts(self.fragment, SyncFIFOBuffered)
        (read,), (write,) = memory.read_ports, memory.write_ports
        (words,) = self.memories.words
        payload = self.dut.o.payload.shape()
        inside = Signal(2)
        m.d.comb += inside.eq(length - fifo.r_rdy)
        self.lemma(m, "counted", (fifo.level == length) & (inside <= ROOM))
        self.lemma(m, "pointers", (write.addr - read.addr)[0] == inside[0])
        for n in range(ROOM):
            word = payload(Mux((read.addr + n)[0], words[1], words[0]))
            seen = Signal(self.beat, name=f"inside_{n}")
            m.d.comb += [
                seen.place.eq(place_of(m, word, f"inside_{n}")),
                seen.end.eq(word.end),
                seen.pixel.depth.eq(word.pixels.depth[self.number]),
                seen.pixel.colour.eq(word.pixels.colour[self.number]),
            ]
            due = Mux(fifo.r_rdy, queue[n + 1], queue[n])
            self.lemma(m, f"inside_{n}", (inside <= n) | self._same(seen, self.beat(due)))

        # The last place that was taken, on whichever side, and that the places rise inside.
        last, newest = Signal.like(before.last), Signal.like(before.last)
        m.d.comb += [
            last.eq(Mux(before.last > own.last, before.last, own.last)),
            newest.eq(out.last),
        ]
        for n in range(ROOM + 1):
            after = Mux(queue[n].end, 0, queue[n].place)
            with m.If(length > n):
                m.d.comb += newest.eq(after)
                earlier = Mux(queue[n - 1].end, 0, queue[n - 1].place) if n else out.last
                self.lemma(m, f"rises_{n}", queue[n].place > earlier)
                self.lemma(m, f"ends_{n}", queue[n].end == queue[n].place.all())
        self.lemma(m, "newest", newest == last)
        for name, side in (("before", before), ("own", own)):
            stream = getattr(self.dut, name)
            behind = side.last < last
            self.lemma(m, f"{name}_ahead", ~behind | (stream.valid & (side.place > last)))


PROOFS = [
    Proof(
        name="merger: places and pixels",
        shows="every beat comes out, once, in order, merged where places are equal; "
        "it goes on if both sides offer",
        build=lambda: MergerProperties(PAPER),
        depth=4,
        endless=True,
        faults=(
            Fault("of equals the later", Merger, r"depth <= own", "depth < own"),
            Fault("the same place twice", Merger, r"valid & ~second", "valid & first"),
            Fault("ahead of an end", Merger, r"\(own\.end \| (.*)\)\),", r"\1),"),
            Fault("two ends", Merger, r"before\.end & own\.end", "before.end | own.end"),
            Fault("does not wait", Merger, r"self\.before\.valid & self\.own\.valid\)", "1)"),
            Fault("locks up", Fifo, r"ready\.eq\(fifo\.w_rdy\)", "ready.eq(fifo.r_rdy)"),
            Fault("not held", Fifo, r"r_en\.eq\(self\.o\.ready\)", "r_en.eq(1)"),
        ),
    )
]
