"""Dealing a footprint's words to the eight banks, as many a cycle as the banks can take."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from .bank import BankRequestLayout
from .format import EngineConfig
from .layouts import FootprintLayout

__all__ = ["BANKS", "Scatter"]

BANKS = 8
"""Banks of the window; bank ``(line + 4 * (word % 2)) % 8`` holds a word of a line."""


class Scatter(wiring.Component):
    """Makes a request a bank out of a footprint, and remembers what is done of it.

    A bank holds the even words of one line of the footprint and the odd words of the line four
    above or below, so of three neighbouring words it holds the outer two of one span and the
    middle one of the other: at most three words an element, each in a slot of its own. A bank
    takes the slots that are touched one a cycle, from left to right, whatever the others do. An
    element takes as many cycles as its busiest bank has words; a word that no row touches costs
    nothing.

    **Latency**: 0. **Throughput**: 1 to 3 cycles an element, 1 for most up to four pixels wide.

    Members
    -------
    footprint : In(FootprintLayout)
        The element; steady until ``done``.
    go : In(1)
        Requests may be issued in this cycle.
    whole : In(1)
        All masks are to have all pixels set, for requests that others make; ``go`` is low then.
    conflict : In(8)
        The bank cannot take its request in this cycle.
    want : Out(8)
        The bank has a word of the element left to do, whether or not ``go`` is high.
    requests : Out(8 x BankRequestLayout)
        The words to draw; ``draw`` is set where ``go`` is high and ``conflict`` low.
    done : Out(1)
        ``go`` is high and nothing is left to do after this cycle.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "footprint": In(FootprintLayout(config)),
                "go": In(1),
                "whole": In(1),
                "conflict": In(BANKS),
                "want": Out(BANKS),
                "requests": Out(data.ArrayLayout(BankRequestLayout(config), BANKS)),
                "done": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        footprint = self.footprint
        half_words = [Signal(self.config.word_bits - 1, name=f"half_word_{j}") for j in range(2)]
        m.d.comb += [half_words[j].eq((footprint.word >> 1) + j) for j in range(2)]

        finished = Signal(BANKS)
        for bank in range(BANKS):
            m.d.comb += finished[bank].eq(self._deal(m, bank, half_words))
        m.d.comb += self.done.eq(self.go & finished.all())
        return m

    def _deal(self, m, bank, half_words):
        """Build one bank's share; return the condition that it has nothing left to do."""
        residue, member = bank % 4, bank // 4
        request = self.requests[bank]
        upper, lower = self.footprint.upper[residue], self.footprint.lower[residue]
        group = self.footprint.upper_group[residue]

        def signal(shape, name):
            return Signal(shape, name=f"{name}_{bank}")

        # Whose outer words are in this bank: the upper line's, where line and word agree with it.
        outer_is_lower = signal(1, "outer_is_lower")
        done, left = signal(3, "done"), signal(3, "left")
        slot = signal(2, "slot")
        is_lower = signal(1, "is_lower")
        m.d.comb += [
            outer_is_lower.eq(group[0] ^ self.footprint.word[0] ^ member),
            left.eq(
                Mux(
                    outer_is_lower,
                    Cat(lower.words[0], upper.words[1], lower.words[2]),
                    Cat(upper.words[0], lower.words[1], upper.words[2]),
                )
                & ~done
            ),
            self.want[bank].eq(left.any()),
            # Slot 3 lies in no span: then the mask has all pixels.
            slot.eq(Mux(self.whole, 3, Mux(left[0], 0, Mux(left[1], 1, 2)))),
            is_lower.eq(outer_is_lower ^ slot[0]),
        ]

        # Slots 0 and 2 are two words apart, neighbours in the bank; slot 1 falls on one of them.
        next_word = signal(1, "next_word")
        first, last = signal(4, "first"), signal(4, "last")
        m.d.comb += [
            next_word.eq(slot[1] | (slot[0] & self.footprint.word[0])),
            request.address.eq(
                Cat(Mux(next_word, half_words[1], half_words[0]), (group + is_lower)[:2])
            ),
            first.eq(Mux(is_lower, lower.first, upper.first)),
            last.eq(Mux(is_lower, lower.last, upper.last)),
        ]
        # The span starts in this word or before it, and ends in it or after it.
        begin, end = signal(2, "begin"), signal(2, "end")
        m.d.comb += [
            begin.eq(Mux(first[2:] == slot, first[:2], 0)),
            end.eq(Mux(last[2:] == slot, last[:2], 3)),
        ]
        for pixel in range(self.config.pixels_per_word):
            m.d.comb += request.mask[pixel].eq((begin <= pixel) & (end >= pixel))

        issue = signal(1, "issue")
        m.d.comb += [
            issue.eq(self.go & left.any() & ~self.conflict[bank]),
            request.draw.eq(issue),
        ]
        with m.If(self.done):
            m.d.sync += done.eq(0)
        with m.Elif(issue):
            m.d.sync += done.eq(done | Cat(slot == j for j in range(3)))
        several = (left[0] & left[1]) | (left[1] & left[2]) | (left[0] & left[2])
        return ~several & ~(left.any() & self.conflict[bank])
