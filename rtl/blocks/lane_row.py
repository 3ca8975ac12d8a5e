"""A row of lanes: the pixels of every eighth line, for elements that are drawn in one cycle."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout, WordLayout

__all__ = ["HALVES", "BeatWordsLayout", "LaneRow", "RowRequestLayout", "row_address_bits"]

HALVES = ("even", "odd")
"""The words of a line, by what their numbers are."""


def row_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a row's memories: those of its lines, and of half their words."""
    return config.group_bits + config.word_bits - 1


class BeatWordsLayout(data.StructLayout):
    """The two words of a beat."""

    def __init__(self, config: EngineConfig):
        super().__init__(dict.fromkeys(HALVES, WordLayout(config)))


class RowRequestLayout(data.StructLayout):
    """What a row is asked to do in a cycle.

    ``draw``: depth-test the pixels of ``mask``, of those in ``odd`` that of the odd word.
    ``clear``: read both words and leave background there. ``load``: copy a beat there, whatever it
    is. At most one of the three, but that ``draw`` may come with another if its mask is empty, and
    then ``again`` of what is drawn after it means something else. ``addresses``: where the even
    word lies, and where the odd one. ``again``: what was drawn one cycle before, and two cycles
    before, was so in the same even word or in the same odd one, but for the group of its line.
    ``behind``: it was nearer than what is drawn, or as near.
    """

    def __init__(self, config: EngineConfig):
        address = row_address_bits(config)
        super().__init__(
            {
                "draw": 1,
                "clear": 1,
                "load": 1,
                "mask": config.pixels_per_word,
                "odd": config.pixels_per_word,
                "addresses": data.StructLayout(dict.fromkeys(HALVES, address)),
                "again": data.ArrayLayout(data.StructLayout(dict.fromkeys(HALVES, 1)), 2),
                "behind": 2,
            }
        )


class LaneRow(wiring.Component):
    """Reads a pixel a column, tests it, and writes over it if it is behind.

    Each column has a memory for the even words of its lines and one for the odd ones, a pixel a
    word of memory: so nothing need be merged with what was there. An element has a pixel of a
    column in one of the two at most, so they share the comparison, whose LUTs have an input to
    spare for the choice. All memories of a half have one address.

    Three stages: a pixel is *read* in the cycle of the request, *caught* in a register in the next
    and *tested* in the third, at whose end it is written. So it is read before that is written
    which was requested a cycle before; and while that is written which was requested two cycles
    before, so that what is read may be anything. No pixel is handed on for that, as an element has
    one depth. Where the one of two cycles before was written, what is drawn passes if it is nearer,
    and only then. Where the one of a cycle before was, it passes as if that had not been there, and
    is written after it; or not at all, if it is not nearer.

    What is cleared is read into a register, which has background otherwise. So what leaves the
    window is what all rows have there together, and is not chosen from them.

    A beat is loaded through the port that reads, which has no other use for that cycle: so it takes
    no multiplexer, and the other port may write at the same time, but not the same pixel.

    Nothing ever stands still: whoever has a word cleared must have room for it.

    **Latency**: 2 cycles to ``leaving``, 3 to the memory, 1 for a load. A line of which something
    is cleared may be drawn into or loaded three cycles later, and what is drawn cleared.
    **Throughput**: one request a cycle.

    Members
    -------
    request : In(RowRequestLayout)
        What to do.
    new : In(PixelLayout)
        What to draw, in the cycle after the request.
    loaded : In(BeatWordsLayout)
        What to load, in the cycle of the request.
    outside : In(2 x pixels_per_word)
        Pixels of what is requested to be cleared that leave as background, whatever they were.
    leaving : Out(BeatWordsLayout)
        The words that were requested to be cleared two cycles before, as they were, else
        background.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "request": In(RowRequestLayout(config)),
                "new": In(PixelLayout(config)),
                "loaded": In(BeatWordsLayout(config)),
                "outside": In(data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word))),
                "leaving": Out(BeatWordsLayout(config)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        request = self.request
        background = config.background_depth
        columns = range(config.pixels_per_word)
        words = data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word))

        # What is cleared is drawn in both words, and before whatever is there. Registers without a
        # reset, as that is what they are set or cleared with for nothing.
        caught = Signal(RowRequestLayout(config))
        mask = Signal(config.pixels_per_word, reset_less=True)  # of what is drawn
        addresses = Signal.like(caught.addresses, name="addresses")
        draws = Signal(config.pixels_per_word, init=-1, reset_less=True)
        not_even = Signal(config.pixels_per_word, reset_less=True)
        odd = Signal(config.pixels_per_word, init=-1, reset_less=True)
        before = Signal(config.depth_bits, reset_less=True)  # what it must lie before
        depth = Signal(config.depth_bits, init=background, reset_less=True)
        colour = Signal(config.colour_bits, reset_less=True)
        m.d.sync += [
            caught.eq(request),
            mask.eq(Mux(request.draw, request.mask, 0)),
            addresses.eq(caught.addresses),
            not_even.eq(Mux(caught.clear, 0, caught.odd)),
            odd.eq(Mux(caught.clear, -1, caught.odd)),
            before.eq(Mux(caught.clear, 0, self.new.depth)),
            depth.eq(Mux(caught.clear, background, self.new.depth)),
            colour.eq(Mux(caught.clear, 0, self.new.colour)),
        ]
        kept = Signal(words, reset_less=True)  # pixels that do not leave, for those that are read
        for half in HALVES:
            m.d.sync += [
                keep.eq(Mux(outside, 1, ~request.clear))
                for keep, outside in zip(
                    getattr(kept, half), getattr(self.outside, half), strict=True
                )
            ]
        written = Signal(words)
        hidden, twice, behind = self._meet(m, caught, addresses, written)

        blank = {"depth": [background for _ in columns]}
        leaving = Signal(
            BeatWordsLayout(config), init=dict.fromkeys(HALVES, blank), reset_less=True
        )
        m.d.comb += self.leaving.eq(leaving)
        for column in columns:
            olds, writes = {}, {}
            for half in HALVES:
                ram = memory.Memory(
                    shape=PixelLayout(config),
                    depth=1 << row_address_bits(config),
                    init=[],
                    # Nobody uses a pixel that was read while it was being written.
                    attrs={"ram_style": "block", "no_rw_check": 1},
                )
                m.submodules[f"{half}_{column}"] = ram
                read, load, write = ram.read_port(), ram.write_port(), ram.write_port()
                loaded = getattr(self.loaded, half)
                m.d.comb += [
                    read.addr.eq(getattr(request.addresses, half)),
                    # Of the same address: the two are one port of the block RAM.
                    load.addr.eq(getattr(request.addresses, half)),
                    load.en.eq(request.load),
                    load.data.depth.eq(loaded.depth[column]),
                    load.data.colour.eq(loaded.colour[column]),
                    write.addr.eq(getattr(addresses, half)),
                    write.data.depth.eq(depth),
                    write.data.colour.eq(colour),
                ]
                word, keep = getattr(leaving, half), getattr(kept, half)[column]
                name = f"old_{half}_{column}"
                old = Signal(config.depth_bits, name=name, init=background, reset_less=True)
                m.d.sync += [
                    word.depth[column].eq(Mux(keep, background, read.data.depth)),
                    word.colour[column].eq(Mux(keep, 0, read.data.colour)),
                    old.eq(Mux(caught.clear, background, read.data.depth)),
                ]
                olds[half], writes[half] = old, write
            # Not ``<``: in this order the choice rides on the LUTs of the carry chain. The bit
            # above the depths is the same on both sides and changes nothing, unless the pixel was
            # written two cycles before: then it alone decides.
            meets = Mux(odd[column], twice.odd[column], twice.even[column])
            other = Mux(odd[column], olds["odd"], olds["even"])
            difference = Signal(config.depth_bits + 2, name=f"difference_{column}")
            passes = Signal(name=f"passes_{column}")
            m.d.sync += draws[column].eq(Mux(caught.clear, 1, mask[column]))
            m.d.comb += [
                difference.eq(Cat(before, behind) - Cat(other, behind ^ meets)),
                passes.eq(difference[-1] & draws[column]),
                written.even[column].eq(passes & ~not_even[column] & ~hidden.even[column]),
                written.odd[column].eq(passes & odd[column] & ~hidden.odd[column]),
                writes["even"].en.eq(written.even[column]),
                writes["odd"].en.eq(written.odd[column]),
            ]
        return m

    def _meet(self, m, caught, addresses, written):
        """Return what of the pixels that are tested was written just before.

        Those written a cycle before that are not to be drawn, as that lies before; those written
        two cycles before; and whether that lay before.
        """
        words = written.shape()
        hidden, again, twice = (
            Signal(words, name=name, reset_less=True) for name in ("hidden", "again", "twice")
        )
        behind = Signal(reset_less=True)
        m.d.sync += [twice.eq(again), behind.eq(caught.behind[1])]
        for half in HALVES:
            now, then, last = (
                getattr(place, half)[self.config.word_bits - 1 :]  # the group of its line
                for place in (self.request.addresses, caught.addresses, addresses)
            )
            hides = getattr(caught.again[0], half) & caught.behind[0] & (then == last)
            meets = getattr(self.request.again[1], half) & (now == last)
            there = getattr(written, half)
            m.d.sync += [
                getattr(hidden, half).eq(Mux(hides & ~caught.clear, there, 0)),
                getattr(again, half).eq(Mux(meets & ~self.request.clear, there, 0)),
            ]
        return hidden, twice, behind
