"""Dealing a footprint's words to the eight banks, as many a cycle as the banks can take."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import BANKS, bank_address_bits, column_bits
from .format import EngineConfig
from .layouts import DealLayout, FootprintLayout

__all__ = ["Scatter"]


class Scatter(wiring.Component):
    """Deals each bank the words of a footprint that lie in it, one at a time.

    A bank holds the even words of one line of the footprint and the odd words of the line four
    above or below, so of three neighbouring words it holds the outer two of one span and the
    middle one of the other: at most three words an element, each in a slot of its own. They are
    dealt from left to right, a word to each bank at a time. A bank takes its word when it can,
    whatever the others do; once all have taken theirs the next ones are dealt, of this element or
    of the one that follows. An element takes as many deals as its busiest bank has words, at least
    one; a word that no row touches costs nothing.

    **Latency**: 1 cycle. **Throughput**: 1 to 3 cycles an element, 1 for most up to four pixels
    wide.

    Members
    -------
    i : In(stream of FootprintLayout)
        The elements; no end tokens.
    enable : In(1)
        Low: the banks stand still, and nothing is dealt or taken.
    taken : In(8)
        Banks that take their word in this cycle; only of those that ``want`` one.
    moves : Out(1)
        What ``o`` has in the next cycle is of the element at hand, or nothing: its colour moves on.
    o : Out(stream of DealLayout)
        What the banks are to draw. ``ready`` is high in the cycle in which the last of them is
        taken.
    drawn : In(8)
        Banks that took a word one cycle before.
    addresses : In(8 x bank_address_bits)
        Which word.
    stale : Out(8)
        The bank has just begun to draw into the very word that it wants next: it waits until that
        is written, for a cycle with further planes, else for two.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(FootprintLayout(config))),
                "enable": In(1),
                "taken": In(BANKS),
                "moves": Out(1),
                "o": Out(stream.Signature(DealLayout(config))),
                "drawn": In(BANKS),
                "addresses": In(data.ArrayLayout(bank_address_bits(config), BANKS)),
                "stale": Out(BANKS),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        footprint = self.i.payload
        valid = Signal()
        deal = Signal(DealLayout(self.config), reset_less=True)
        following = Signal(DealLayout(self.config))
        slow = self.config.colour_planes == 1  # a bank writes a word one cycle later
        again, rests = Signal(BANKS), Signal(BANKS)
        stale = Signal(BANKS)
        staler = Signal(BANKS)  # for another cycle
        step = Signal()
        several = Signal(BANKS)  # the bank has words left after the following one
        same = Signal(BANKS)  # the following one is the word that it is to draw now
        earlier = Signal(BANKS)  # or the one that it drew a cycle ago

        half_words = [Signal(self.config.word_bits - 1, name=f"half_word_{j}") for j in range(2)]
        m.d.comb += [half_words[j].eq((footprint.word >> 1) + j) for j in range(2)]
        for bank in range(BANKS):
            m.d.comb += [
                several[bank].eq(self._deal(m, bank, half_words, following, step)),
                same[bank].eq(deal.shares[bank].address == following.shares[bank].address),
                earlier[bank].eq(
                    self.drawn[bank] & (self.addresses[bank] == following.shares[bank].address)
                ),
            ]

        # The stretches of marks that it lies in: that of its first word, and the next one if its
        # third word may lie there.
        low = column_bits(self.config) + 1
        stretch, across = footprint.word[low:], footprint.word[1:low].all()
        m.d.comb += [
            following.z.eq(footprint.z),
            following.reach.eq(
                Cat(
                    (stretch == number) | (across & (stretch == number - 1))
                    for number in range(len(following.reach))
                )
            ),
            step.eq((~valid & self.enable) | self.o.ready),
            self.moves.eq(step),
            self.i.ready.eq(step & ~several.any()),
            self.o.valid.eq(valid),
            self.o.payload.eq(deal),
            self.stale.eq(stale),
            again.eq(same & deal.want & valid.replicate(BANKS)),
            rests.eq(again | earlier if slow else again),
        ]
        with m.If(step):
            m.d.sync += [
                valid.eq(self.i.valid),
                deal.eq(following),
                stale.eq(rests),
                staler.eq(again if slow else 0),
            ]
        with m.Else():
            m.d.sync += deal.want.eq(deal.want & ~self.taken)
            with m.If(self.enable):
                m.d.sync += [stale.eq(staler), staler.eq(0)]
        return m

    def _deal(self, m, bank, half_words, following, step):
        """Build one bank's share; return whether it has words left after that."""
        residue, member = bank % 4, bank // 4
        footprint = self.i.payload
        upper, lower = footprint.upper[residue], footprint.lower[residue]
        group = footprint.upper_group[residue]
        share = following.shares[bank]

        def signal(shape, name):
            return Signal(shape, name=f"{name}_{bank}")

        # Whose outer words are in this bank: the upper line's, where line and word agree with it.
        outer_is_lower = signal(1, "outer_is_lower")
        done, left = signal(3, "done"), signal(3, "left")
        slot = signal(2, "slot")
        is_lower = signal(1, "is_lower")
        m.d.comb += [
            outer_is_lower.eq(group[0] ^ footprint.word[0] ^ member),
            left.eq(
                Mux(
                    outer_is_lower,
                    Cat(lower.words[0], upper.words[1], lower.words[2]),
                    Cat(upper.words[0], lower.words[1], upper.words[2]),
                )
                & ~done
            ),
            following.want[bank].eq(left.any()),
            slot.eq(Mux(left[0], 0, Mux(left[1], 1, 2))),
            is_lower.eq(outer_is_lower ^ slot[0]),
        ]

        # Slots 0 and 2 are two words apart, neighbours in the bank; slot 1 falls on one of them.
        next_word = signal(1, "next_word")
        first, last = signal(4, "first"), signal(4, "last")
        m.d.comb += [
            next_word.eq(slot[1] | (slot[0] & footprint.word[0])),
            share.address.eq(
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
            m.d.comb += share.mask[pixel].eq((begin <= pixel) & (end >= pixel))

        several = signal(1, "several")
        m.d.comb += several.eq((left[0] & left[1]) | (left[1] & left[2]) | (left[0] & left[2]))
        with m.If(self.i.valid & self.i.ready):
            m.d.sync += done.eq(0)
        with m.Elif(self.i.valid & step):
            m.d.sync += done.eq(done | Cat(slot == j for j in range(3)))
        return several
