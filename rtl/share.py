"""What one bank of the window is dealt of a footprint."""

from amaranth.hdl import Cat, Mux, Signal

__all__ = ["ShareOfEight", "ShareOfPair", "ShareOfSixteen"]


class Share:
    """One bank's words of a footprint, of which it is dealt one at a time.

    Of the neighbouring words that an element may touch each lies in a slot, 0 to 2 from the left,
    or 0 and 1 with words of eight pixels. Combinational but for what was dealt before. ``find`` of
    the bank's class puts it into a module.

    Parameters
    ----------
    bank
        Its number.
    pixels
        Pixels of a word, 4 or 8.
    elements
        The stream of footprints.
    half_words
        The number of the first word in its half of the line, and the one after.

    Attributes
    ----------
    want
        The bank has a word in this deal.
    several
        It has words left after that; never with words of eight pixels, of which it has one.
    address
        The word's address in the bank.
    mask
        Its pixels that are covered.
    """

    def __init__(self, bank, pixels, elements, half_words):
        self.bank = bank
        self.pixels = pixels
        self.elements = elements
        self.half_words = half_words
        self.want, self.several = self.signal(1, "want"), self.signal(1, "several")
        self.is_lower = self.signal(1, "is_lower")  # the lower one of the residue's two spans

    def signal(self, shape, name):
        """Return a signal that is named after the bank."""
        return Signal(shape, name=f"{name}_{self.bank}")

    def place(self, m, residue, lines_bit, next_word, starts, ends):
        """Find the word's address and pixels.

        Parameters
        ----------
        m
            The module.
        residue
            Of the span's line modulo 4.
        lines_bit
            Of the line's place in the window, the first bit that is part of an address: 2 or 3.
        next_word
            The word is the second of the half words.
        starts, ends
            Take a span's first and last column: the span starts, ends in the word's slot. If not,
            it reaches in from the left, on to the right.
        """
        footprint = self.elements.payload
        upper, lower = footprint.upper[residue], footprint.lower[residue]
        group = (footprint.upper_group[residue] + self.is_lower)[:2]
        first, last = self.signal(4, "first"), self.signal(4, "last")
        column = range(self.pixels)
        bits = len(column).bit_length() - 1
        begin, end = self.signal(column, "begin"), self.signal(column, "end")
        m.d.comb += [
            first.eq(Mux(self.is_lower, lower.first, upper.first)),
            last.eq(Mux(self.is_lower, lower.last, upper.last)),
            begin.eq(Mux(starts(first), first[:bits], 0)),
            end.eq(Mux(ends(last), last[:bits], column[-1])),
        ]
        self.address = Cat(Mux(next_word, *reversed(self.half_words)), group[lines_bit - 2 :])
        self.mask = Cat((begin <= pixel) & (end >= pixel) for pixel in column)


class ShareOfEight(Share):
    """The outer two words of one line, and the middle one of the line four above or below."""

    def find(self, m, dealt):
        """Add the circuit to ``m``; ``dealt``: the word is dealt, and the element may have more."""
        footprint = self.elements.payload
        member, residue = divmod(self.bank, 4)
        upper, lower = footprint.upper[residue], footprint.lower[residue]
        group = footprint.upper_group[residue]

        # Whose outer words are in this bank: the upper line's, where line and word agree with it.
        outer_is_lower = self.signal(1, "outer_is_lower")
        done, left = self.signal(3, "done"), self.signal(3, "left")
        slot = self.signal(2, "slot")
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
            self.want.eq(left.any()),
            self.several.eq((left[0] & left[1]) | (left[1] & left[2]) | (left[0] & left[2])),
            slot.eq(Mux(left[0], 0, Mux(left[1], 1, 2))),
            self.is_lower.eq(outer_is_lower ^ slot[0]),
        ]
        with m.If(self.elements.valid & self.elements.ready):
            m.d.sync += done.eq(0)
        with m.Elif(dealt):
            m.d.sync += done.eq(done | Cat(slot == j for j in range(3)))
        self.place(
            m,
            residue,
            2,
            # Slots 0 and 2 are two words apart, neighbours in the bank; slot 1 falls on one of
            # them.
            next_word=slot[1] | (slot[0] & footprint.word[0]),
            starts=lambda first: first[2:] == slot,
            ends=lambda last: last[2:] == slot,
        )


class ShareOfSixteen(Share):
    """The outer two words of a line, or its middle one."""

    def find(self, m, second):
        """Add the circuit to ``m``; ``second``: the element's second deal, of its right word."""
        footprint = self.elements.payload
        member, line = divmod(self.bank, 8)
        residue = line % 4
        middle = footprint.word[0] ^ member  # the bank has the middle word
        words = self.signal(3, "words")
        both = self.signal(1, "both")  # outer words are touched
        right = self.signal(1, "right")  # of them the right one
        m.d.comb += [
            self.is_lower.eq(footprint.upper_group[residue][0] ^ (line // 4)),
            words.eq(
                Mux(self.is_lower, footprint.lower[residue].words, footprint.upper[residue].words)
            ),
            both.eq(words[0] & words[2]),
            self.several.eq(~middle & both & ~second),
            self.want.eq(Mux(second, both & ~middle, Mux(middle, words[1], words[0] | words[2]))),
            right.eq(~middle & (second | ~words[0])),
        ]
        self.place(
            m,
            residue,
            3,
            next_word=right | (middle & footprint.word[0]),
            # What touches the first word starts there, and what touches the third ends there.
            starts=lambda first: Mux(middle, first[2], ~right | first[3]),
            ends=lambda last: Mux(middle, last[2], right | ~last[2:].any()),
        )


class ShareOfPair(Share):
    """The left or the right one of a line's two words of eight pixels."""

    def find(self, m, _):
        """Add the circuit to ``m``; the other argument is not used: every element has one deal."""
        footprint = self.elements.payload
        member, line = divmod(self.bank, 8)
        residue = line % 4
        right = footprint.word[0] ^ member  # the bank has the right word
        words = self.signal(2, "words")
        m.d.comb += [
            self.is_lower.eq(footprint.upper_group[residue][0] ^ (line // 4)),
            words.eq(
                Mux(self.is_lower, footprint.lower[residue].words, footprint.upper[residue].words)
            ),
            self.want.eq(Mux(right, words[1], words[0])),
        ]
        self.place(
            m,
            residue,
            3,
            next_word=right & footprint.word[0],
            starts=lambda first: ~right | first[3],
            ends=lambda last: right | ~last[3],
        )
