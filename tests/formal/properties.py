"""What properties are made of: a component with free inputs, its streams' rules, its memories."""

from abc import ABC, abstractmethod

from amaranth.asserts import AnyConst, AnySeq, Initial
from amaranth.hdl import (
    Assert,
    Assume,
    Cat,
    Const,
    Elaboratable,
    Fragment,
    Module,
    Mux,
    ResetSignal,
    Signal,
    Value,
)
from amaranth.lib.wiring import Out

from splatline.contract.presets import PAPER, SWIFT

__all__ = ["SWIFT_NINE", "OneWord", "Properties", "any_constant", "any_value", "covers", "parts"]

SWIFT_NINE = SWIFT.replace(
    channel_bits=PAPER.channel_bits,
    coefficient_bits=PAPER.coefficient_bits,
    colour_shift=PAPER.colour_shift,
)
"""``swift`` with 9 bits of colour: no property depends on how many there are, but its time does."""


def any_value(m, shape, name):
    """Return a signal that has any value in any cycle."""
    signal = Signal(shape, name=name)
    m.d.comb += Value.cast(signal).eq(AnySeq(len(Value.cast(signal))))
    return signal


def any_constant(m, shape, name):
    """Return a signal that has any value, and keeps it."""
    signal = Signal(shape, name=name)
    m.d.comb += Value.cast(signal).eq(AnyConst(len(Value.cast(signal))))
    return signal


def covers(element, row, column):
    """Return whether an element has a pixel in a row of its block and a column of the image.

    This is the contract's text: rows 0..3 as given, row 7 - k as row k turned, or empty; of a
    raised shape row 3 with its ends exchanged, and row 6 - k as row k turned. What is turned lies
    one column further right, or not.
    """
    symmetric = element.mode == 0
    scans = element.scans
    raised = symmetric & (scans[3].first >= 4) & (scans[3].last <= 3)
    at_half = Mux(
        raised,
        ((scans[3].first + scans[3].last) & 1) == 0,
        (scans[0].first > scans[0].last) & scans[0].first[1],
    )
    found = 0
    for number in range(8):
        upper, centred = number < 4, min(number, 7 - number)
        for is_raised in range(2):
            k = centred if upper else centred - is_raised
            if k < 0:
                continue
            scan = scans[k]
            first, last = scan.first, scan.last
            if k == 3 and is_raised:
                first, last = last, first
            if not upper:
                first, last = 7 + at_half - last, 7 + at_half - first
            there = (raised == is_raised) & (upper | symmetric)
            across = (first <= column - element.x) & (column - element.x <= last)
            found = found | ((row == number) & there & across)
    return found & ~element.end


def parts(fragment, kind):
    """Return the components of a kind that are inside a fragment, in the order of their making."""
    own = [origin for origin in fragment.origins or () if isinstance(origin, kind)]
    return own + [part for inner, *_ in fragment.subfragments for part in parts(inner, kind)]


class OneWord:
    """Block RAMs of which one word is kept; any other one reads as anything.

    So does a word that is read in the cycle in which it is written, as a block RAM may do. It has
    at the start what it likes. What holds with such memories holds with those of any size.

    Of two ports that write, never both write the same word in a cycle, which is asserted: a block
    RAM leaves undefined what it has then.

    This is a platform: :class:`amaranth.lib.memory.Memory` asks ``get_memory`` for what it is.
    Memories of LUTs stay what they are.

    Parameters
    ----------
    address
        A signal: which word of each memory is kept. If a memory's addresses have more bits, then
        a word for each value of those.
    init
        What those words are after the reset, the same in all memories or a value for each of them;
        anything unless it is given.
    styles
        Which memories are modelled, by their ``ram_style``; ``None`` is what has none.
    apart
        If not, it is not asserted that two ports write different words, for what is proven holds
        whatever they have.

    Attributes
    ----------
    words
        The words that are kept, of each memory in the order in which they were built.
    """

    def __init__(self, address, init=None, styles=("block",), apart=True):
        self.address = address
        self.init = init
        self.styles = styles
        self.apart = apart
        self.words = []

    def get_memory(self, memory):
        """Build the model of a memory with one port to read and up to two to write."""
        if memory.attrs.get("ram_style") not in self.styles:
            return memory.elaborate(None)
        (read,) = memory.read_ports
        m = Module()
        low, width = len(self.address), len(Value.cast(read.data))
        data = Signal(width, reset_less=True)
        garbage = any_value(m, width, "garbage")
        m.d.comb += Value.cast(read.data).eq(data)
        with m.If(read.en):
            m.d.sync += data.eq(garbage)
        if not memory.write_ports:
            return m  # whatever a memory that is only read may hold
        two = len(memory.write_ports) == 2
        init = self.init[len(self.words)] if isinstance(self.init, tuple) else self.init
        words = [
            Signal(width, name=f"word_{part}", init=init or 0, reset_less=init is None)
            for part in range(memory.depth >> low)
        ]
        self.words.append(words)
        for part, word in enumerate(words):
            mine = Cat(self.address, Const(part, len(read.addr) - low))
            written = Signal(len(memory.write_ports), name=f"written_{part}")
            for number, write in enumerate(memory.write_ports):
                m.d.comb += written[number].eq(write.en & (write.addr == mine))
                with m.If(written[number]):
                    m.d.sync += word.eq(Value.cast(write.data))
            if two:
                with m.If(written.all()):
                    m.d.sync += word.eq(garbage)
            with m.If(read.en & (read.addr == mine) & ~written.any()):
                m.d.sync += data.eq(word)
            if two and self.apart:
                met = Signal(name=f"both_write_{part}")
                m.d.comb += [met.eq(written.all()), Assert(~met | ResetSignal())]
        return m


class Properties(ABC, Elaboratable):
    """A component, what is assumed of its inputs and what is asserted of its outputs.

    It starts in any state, registers and memories alike, and is reset for one cycle.

    Members
    -------
    memories
        The platform that says what memories are; ``None``: what they are.
    lemmas
        Whether what an induction needs is asserted as well. Not when a fault is to be found: it
        must break what is promised.
    """

    memories = None
    lemmas = True

    def elaborate(self, platform):
        """Build the properties."""
        m = Module()
        m.d.comb += Assume(ResetSignal() == Initial())
        self.describe(m)
        return m

    @abstractmethod
    def describe(self, m):
        """Add the component and all that is said of it."""

    def add(self, m, component, name="dut"):
        """Add a component now, so that what its memories keep is known; return its fragment."""
        m.submodules[name] = fragment = Fragment.get(component, self.memories)
        return fragment

    def always(self, m, name, condition):
        """Assert that something holds in every cycle after the reset."""
        holds = Signal(name=f"holds_{name}")
        m.d.comb += holds.eq(condition)
        m.d.comb += Assert(holds | ResetSignal())

    def lemma(self, m, name, condition):
        """Assert what nobody outside sees, but without which an induction does not close."""
        if self.lemmas:
            self.always(m, name, condition)

    def given(self, m, name, condition):
        """Assume something in every cycle after the reset."""
        given = Signal(name=f"given_{name}")
        m.d.comb += given.eq(condition)
        m.d.comb += Assume(given | ResetSignal())

    def free(self, m, component, **values):
        """Give every input of a component any value, or the one that is named here."""
        for path, member, value in component.signature.flatten(component):
            name = "_".join(map(str, path))
            if member.flow is not Out and values.get(path[0], True) is not None:
                source = values.get(name, values.get(path[0]))
                if source is None:
                    source = any_value(m, member.shape, f"any_{name}")
                m.d.comb += Value.cast(value).eq(Value.cast(source))

    def steady(self, m, stream, name):
        """Return whether a stream keeps its word: what is offered stays until it is taken."""
        now = Value.cast(stream.payload)
        waiting = Signal(name=f"{name}_waiting")
        before = Signal(len(now), name=f"{name}_before")
        m.d.sync += [waiting.eq(stream.valid & ~stream.ready), before.eq(now)]
        return ~waiting | (stream.valid & (now == before))
