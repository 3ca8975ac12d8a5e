"""The way along the lines that leave the banks: to each word that was drawn into, and no other."""

from amaranth.hdl import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import bank_address_bits, column_bits, residue_bits, stretch_bits, turned
from .bank_marks import BankMarks
from .changeover import Changeover
from .choose import number_of
from .format import EngineConfig
from .layouts import FlushLayout

__all__ = ["BankWalker"]

STAGES = ("found", "left")


class BankWalker(wiring.Component):
    """Asks for each drawn word of the lines that no later element touches to be flushed.

    Line n of the image stands in place n mod 16 of the window. ``oldest`` is the first line that
    has not left: lines ``oldest .. oldest + 15`` are in the window, those above ``top`` are on
    their way out. A line that nothing was drawn into takes one cycle, and all are stepped over at
    once if none was. Once a frame was closed, all its lines are on their way out, and ``top`` and
    what is drawn are the next frame's (see :class:`Changeover`).

    Marks are read ahead: while the words of a stretch are asked for, the next one that has any is
    fetched, in a cycle in which its line's banks mark nothing. So flushing waits for marks only
    where they are sparse. With a mark for each word (``mark_words`` 1) a stretch that no element
    has reached since the window was last clean is not read: a few elements cost a few cycles. And
    ``front`` says already with the last word that it asks for how far the window goes on, where
    nothing is drawn that may keep that word waiting.

    Where the raster's beats have two words, two neighbours that are both drawn are asked for
    together. Up to two of what is asked for wait to be taken.

    **Latency**: 3 cycles from a complete line to its first word. **Throughput**: one word a cycle,
    or a beat's two, and at least one cycle a stretch of sixteen that was reached.

    Members
    -------
    top : In(signed(line_bits + 2))
        Lines above this one are complete. Never falls during a frame.
    limit : In(signed(line_bits + 2))
        Lines above this one have received all of the initial raster that is meant for them.
    jump : In(1)
        No initial raster will come for any line, and ``limit`` means nothing: lines that nothing
        was drawn into may be stepped over all at once.
    last_word : In(word_bits)
        Number of the last word of a line.
    reaching : In(1)
        Something may be drawn in this cycle into the stretches ``reach``.
    reach : In(2 ** stretch_bits)
        Means nothing unless ``jump``: an initial raster may lie anywhere.
    drawn : In(banks)
        The bank writes what was drawn into its word at ``addresses``, one cycle after the request.
    addresses : In(banks x bank_address_bits)
        Which word.
    wipe : In(1)
        Clear the marks about ``addresses``, as after a reset: see :class:`BankMarks`.
    idle : In(1)
        Nothing is drawn in this cycle or the next. What is asked for in the next one is then taken
        at once, unless the window stands still, in which no element moves either.
    close : In(1)
        The frame at hand is complete; not while ``closing``.
    restart : In(1)
        The closed frame is over: go on with line 0 of the next.
    oldest : Out(line_bits + 1)
        First line in the window, of the frame that leaves; or what it is once the word asked for at
        the moment is taken. No element behind that is drawn before the second cycle after this one
        (see :class:`Decoder`), when the word is cleared.
    front : Out(signed(line_bits + 2))
        The same of the frame that is drawn.
    closing : Out(1)
        A frame was closed and is not over.
    over : Out(1)
        Nothing of the closed frame is in the window any more.
    flush : Out(stream of FlushLayout)
        Words to read and clear.
    early : Out(1)
        ``oldest`` counts on it that ``flush`` is taken at once: it goes before the initial raster
        of the next frame.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "top": In(signed(config.line_bits + 2)),
                "limit": In(signed(config.line_bits + 2)),
                "jump": In(1),
                "last_word": In(config.word_bits),
                "reaching": In(1),
                "reach": In(1 << stretch_bits(config)),
                "drawn": In(config.banks),
                "addresses": In(data.ArrayLayout(bank_address_bits(config), config.banks)),
                "wipe": In(1),
                "idle": In(1),
                "close": In(1),
                "restart": In(1),
                "oldest": Out(config.line_bits + 1),
                "front": Out(signed(config.line_bits + 2)),
                "closing": Out(1),
                "over": Out(1),
                "flush": Out(stream.Signature(FlushLayout(config))),
                "early": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        m.submodules.marks = marks = BankMarks(config)
        m.submodules.changeover = changeover = Changeover(config)
        written = Signal(config.window_lines)
        clean = Signal()
        empty = Signal()  # and stays so, as what is drawn is written one cycle later
        closing = Signal()
        leaves = Signal()
        jumps = Signal()  # nothing is written in any line above ``top``
        asked_line = Signal.like(self.oldest)  # the first one but for what was asked for last
        early = Signal()  # ``line`` is known to be the window's first once ``flush`` is taken

        # The stretch that is read next.
        line = Signal(len(self.oldest))
        stretch = Signal(stretch_bits(config))
        last = Signal()  # it is the line's last
        # What was read and waits, and what is left of the stretch at hand: the words' marks, the
        # line and the stretch.
        found, left = (Signal(len(marks.bits), name=name) for name in STAGES)
        line_found, line_left = (Signal.like(line, name=f"line_{name}") for name in STAGES)
        stretch_found, stretch_left = (
            Signal.like(stretch, name=f"stretch_{name}") for name in STAGES
        )
        second_valid = Signal()  # two words, or pairs, are asked for

        # Reading: on through the stretches, past those without marks, until one has some.
        leaving = Signal()
        here = Signal()
        reading = Signal()
        bits = Signal.like(marks.bits)
        waits = Signal()  # what was found does
        moves = Signal()  # nothing will be left of the stretch at hand
        passed = Signal()
        ended = Signal()
        m.d.comb += [
            leaving.eq(
                (((line < self.top) & (self.jump | (line < self.limit))) | closing)
                & ~changeover.halted
            ),
            here.eq(written.bit_select(line[:4], 1)),
            reading.eq(leaving & here & ~marks.busy),
            bits.eq(marks.bits & reading.replicate(len(bits))),
            waits.eq(found.any()),
            passed.eq(reading & (moves | ~waits)),
            ended.eq(passed & last),
            marks.line.eq(line),
            marks.stretch.eq(stretch),
            marks.take.eq(passed),
            marks.drawn.eq(self.drawn),
            marks.addresses.eq(self.addresses),
            marks.wipe.eq(self.wipe),
            clean.eq(~written.any()),
            empty.eq(clean & ~self.drawn.any()),
            changeover.oldest.eq(self.oldest),
            self.oldest.eq(Mux(early, line, asked_line)),
            self.early.eq(early),
            changeover.line.eq(line),
            changeover.leaves.eq(leaves),
            changeover.wraps.eq(Cat(self._wraps(bank, line) for bank in range(config.banks)).any()),
            changeover.clean.eq(empty),
            changeover.close.eq(self.close),
            changeover.restart.eq(self.restart),
            closing.eq(changeover.closing),
            self.front.eq(changeover.front),
            self.closing.eq(closing),
            self.over.eq(changeover.over & ~Cat(found, left, self.flush.valid).any()),
        ]
        # What is read waits only where something is left of the stretch before.
        with m.If(moves | ~waits):
            m.d.sync += [
                found.eq(Mux(moves & ~waits, 0, bits)),
                line_found.eq(line),
                stretch_found.eq(stretch),
            ]
        if config.mark_words == 1:
            self._choose_stretch(m, stretch, last, passed, empty)
        else:
            m.d.comb += last.eq(stretch == self.last_word[column_bits(config) + 1 :])
            with m.If(passed):
                m.d.sync += stretch.eq(Mux(last, 0, stretch + 1))
        m.d.comb += [
            leaves.eq(ended | (leaving & ~here)),
            jumps.eq(leaving & self.jump & clean & ~closing),
        ]
        with m.If(jumps):
            m.d.sync += line.eq(self.top)
        with m.Elif(leaves & ~changeover.last):
            m.d.sync += line.eq(line + 1)

        # Asking: the words that are left of the stretch at hand.
        column, two, alone = _first_column(m, left)
        ask = Signal(FlushLayout(config))
        asked = Signal()
        single = Signal()  # it is the last of the stretch
        right_first = turned(config, line_left)
        if config.raster_words == 2:
            m.d.comb += [ask.halves.eq(two), single.eq(alone)]
        else:  # the left one first
            m.d.comb += [
                ask.halves[0].eq(two[0] & ~(right_first & two[1])),
                ask.halves[1].eq(two[1] & ~(~right_first & two[0])),
                single.eq(alone & ~two.all()),
            ]
        m.d.comb += [
            ask.pair.eq(Cat(column, stretch_left)),
            asked.eq(left.any() & ~second_valid),
            moves.eq(~left.any() | (asked & single)),
        ]
        with m.If(moves):
            m.d.sync += [
                left.eq(Mux(waits, found, bits)),
                line_left.eq(Mux(waits, line_found, line)),
                stretch_left.eq(Mux(waits, stretch_found, stretch)),
            ]
        for word in range(len(left)):
            with m.If(asked & ~single & ask.halves[word % 2] & (column == word // 2)):
                m.d.sync += left[word].eq(0)

        # The two that were asked for: whether the first is taken is known too late to ask by it.
        first = Signal(FlushLayout(config), reset_less=True)
        second = Signal.like(first, reset_less=True)
        second_line = Signal.like(line, reset_less=True)
        sole = Signal()  # nothing follows what is asked for
        # Further planes keep a bank from giving up a word at once.
        m.d.comb += sole.eq(~second_valid & moves & ~waits & (config.colour_planes == 1))
        m.d.comb += [self.flush.payload.eq(first), self.flush.payload.line.eq(asked_line)]
        with m.If(~self.flush.valid | self.flush.ready):
            m.d.sync += [
                self.flush.valid.eq(second_valid | asked),
                first.eq(Mux(second_valid, second, ask)),
                second_valid.eq(0),
            ]
            # Nor may a word be marked meanwhile: ``line`` would go on while its own words wait.
            m.d.sync += early.eq(sole & self.idle & jumps & empty)
            with m.If(second_valid):
                m.d.sync += asked_line.eq(second_line)
            with m.Elif(asked):
                m.d.sync += asked_line.eq(line_left)
            with m.Elif(~waits):
                m.d.sync += asked_line.eq(line)
        with m.Elif(asked):
            m.d.sync += [second_valid.eq(1), second.eq(ask), second_line.eq(line_left)]

        for slot in range(config.window_lines):
            group, bank = divmod(slot, config.banks // 2)
            touched = Cat(
                self.drawn[half] & (self._group(half) == group)
                for half in (bank, bank + config.banks // 2)
            ).any()
            with m.If(touched):
                m.d.sync += written[slot].eq(1)
            with m.If(ended & (line[:4] == slot)):
                m.d.sync += written[slot].eq(0)
        with m.If(self.restart):
            m.d.sync += [line.eq(0), asked_line.eq(0)]
        return m

    def _group(self, bank):
        """Return which of its lines a bank writes into: the place but for its lowest bits."""
        return self.addresses[bank][self.config.word_bits - 1 :]

    def _wraps(self, bank, line):
        """Return whether a bank writes into a line whose place is before that of ``line``."""
        bits = residue_bits(self.config)
        place = Cat(Const(bank % (1 << bits), bits), self._group(bank))
        return self.drawn[bank] & (place < line[: self.config.slot_bits])

    def _choose_stretch(self, m, stretch, last, passed, clean):
        """Choose the first stretch that was reached, of those that the line still has.

        It is chosen a cycle ahead, both for if this one is passed and for if not: the way from
        the marks to the next stretch would be the longest of the engine otherwise. A stretch that
        is reached in this cycle counts in the one after the next, in which it can have a mark.
        """
        reached = Signal.like(self.reach)
        ahead = Signal.like(self.reach, init=-1)
        later = Signal.like(self.reach)  # those that are ahead once this one is passed
        chosen = Signal.like(self.reach)
        m.d.comb += [
            later.eq(Mux(last, -1, ahead & ~chosen)),
            stretch.eq(number_of(chosen)),
        ]
        choices = []
        for name, rest in (("same", ahead), ("next", later)):
            wanted = Signal.like(self.reach, name=f"wanted_{name}")
            first = Signal.like(self.reach, name=f"first_{name}")
            no_more = Signal(name=f"last_{name}")
            m.d.comb += [
                wanted.eq(reached & rest),
                first.eq(wanted & (~wanted + 1)),
                no_more.eq(first == wanted),
            ]
            choices.append(Cat(first, no_more, rest))
        m.d.sync += Cat(chosen, last, ahead).eq(Mux(passed, choices[1], choices[0]))
        with m.If(~self.jump):
            m.d.sync += reached.eq(-1)
        with m.Elif(self.reaching):
            m.d.sync += reached.eq(reached | self.reach)
        with m.Elif(clean):
            m.d.sync += reached.eq(0)


def _first_column(m, bits):
    """Return the first column with a mark, its two marks, and whether no other column has any."""
    groups = [bits[base : base + 4] for base in range(0, len(bits), 4)]  # two columns
    some = Signal(len(groups))
    group = Signal(range(len(groups)))
    four = Signal(4)
    second = Signal()
    two = Signal(2)
    alone = Signal()
    m.d.comb += some.eq(Cat(part.any() for part in groups))
    for index in reversed(range(len(groups))):
        with m.If(some[index]):
            m.d.comb += group.eq(index)
    with m.Switch(group):
        for index, part in enumerate(groups):
            with m.Case(index):
                m.d.comb += four.eq(part)
    m.d.comb += [
        second.eq(~four[:2].any()),
        two.eq(Mux(second, four[2:], four[:2])),
        alone.eq(_at_most_one(some) & (second | ~four[2:].any())),
    ]
    column = Cat(second, group)[: (len(bits) // 2 - 1).bit_length()]
    return column, two, alone


def _at_most_one(bits):
    """Return whether no more than one bit is set."""
    return ~Cat(bits[i] & bits[:i].any() for i in range(1, len(bits))).any()
