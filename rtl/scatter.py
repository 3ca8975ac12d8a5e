"""Dealing a footprint's words to the banks, as many a cycle as the banks can take."""

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .bank_layout import column_bits
from .format import EngineConfig
from .layouts import DealLayout, FootprintLayout
from .share import ShareOfEight, ShareOfPair, ShareOfSixteen

__all__ = ["Scatter"]


class Scatter(wiring.Component):
    """Deals each bank the words of a footprint that lie in it, one at a time.

    A bank of eight holds the even words of one line of the footprint and the odd words of the line
    four above or below, so of three neighbouring words it holds the outer two of one span and the
    middle one of the other: at most three words an element, each in a slot of its own. A bank of
    sixteen holds the outer two or the middle one of one line; with words of eight pixels, of which
    a line of a footprint has two at most, the left or the right one. They are dealt from left to
    right, a word to each bank at a time. A bank takes its word when it can, whatever the others do;
    once all have taken theirs the next ones are dealt, of this element or of the one that follows.
    An element takes as many deals as its busiest bank has words, at least one; a word that no row
    touches costs nothing.

    **Latency**: 1 cycle. **Throughput**: 1 to 3 cycles an element, with sixteen banks 1 or 2; 1 for
    most up to four pixels wide, and for all with words of eight.

    Members
    -------
    i : In(stream of FootprintLayout)
        The elements; no end tokens.
    enable : In(1)
        Low: the banks stand still, and nothing is dealt or taken.
    taken : In(banks)
        Banks that take their word in this cycle; only of those that ``want`` one.
    moves : Out(1)
        What ``o`` has in the next cycle is of the element at hand, or nothing: its colour moves on.
    o : Out(stream of DealLayout)
        What the banks are to draw. ``ready`` is high in the cycle in which the last of them is
        taken.
    stale : Out(banks)
        The bank has just begun to draw into the very word that it wants next: it waits for a cycle,
        until that is written.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(FootprintLayout(config))),
                "enable": In(1),
                "taken": In(config.banks),
                "moves": Out(1),
                "o": Out(stream.Signature(DealLayout(config))),
                "stale": Out(config.banks),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        footprint = self.i.payload
        banks = self.config.banks
        valid = Signal()
        deal = Signal(DealLayout(self.config), reset_less=True)
        following = Signal(DealLayout(self.config))
        again = Signal(banks)  # what is dealt next is the word that the bank is to draw now
        stale = Signal(banks)
        step = Signal()
        several = Signal(banks)  # the bank has words left after the following one
        same = Signal(banks)

        half_words = [Signal(self.config.word_bits - 1, name=f"half_word_{j}") for j in range(2)]
        m.d.comb += [half_words[j].eq((footprint.word >> 1) + j) for j in range(2)]
        dealt = self.i.valid & step
        second = Signal()  # of sixteen banks: the element's second deal, which is its last
        pixels = self.config.pixels_per_word
        if banks == 8:
            share_of, found_by = ShareOfEight, dealt
        elif self.config.block_words == 2:
            share_of, found_by = ShareOfPair, None
        else:
            share_of, found_by = ShareOfSixteen, second
            with m.If(dealt):
                m.d.sync += second.eq(~self.i.ready)
        shares = [share_of(bank, pixels, self.i, half_words) for bank in range(banks)]
        for share in shares:
            share.find(m, found_by)
        for bank, share in enumerate(shares):
            m.d.comb += [
                several[bank].eq(share.several),
                following.want[bank].eq(share.want),
                following.shares[bank].address.eq(share.address),
                following.shares[bank].mask.eq(share.mask),
                same[bank].eq(deal.shares[bank].address == following.shares[bank].address),
            ]

        # The stretches of marks that it lies in: that of its first word, and the next one if its
        # last word may lie there, the third or, of eight pixels, the second.
        low = column_bits(self.config) + 1
        behind_pair = self.config.block_words - 2
        stretch, across = footprint.word[low:], footprint.word[behind_pair:low].all()
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
            again.eq(same & deal.want & valid.replicate(banks)),
        ]
        with m.If(step):
            m.d.sync += [
                valid.eq(self.i.valid),
                deal.eq(following),
                stale.eq(again),
            ]
        with m.Else():
            m.d.sync += deal.want.eq(deal.want & ~self.taken)
            with m.If(self.enable):
                m.d.sync += stale.eq(0)
        return m
