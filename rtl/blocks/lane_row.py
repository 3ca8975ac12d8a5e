"""A row of lanes: the pixels of every eighth line, for elements that are drawn in one cycle."""

from typing import NamedTuple

from amaranth.hdl import Cat, Module, Mux, Signal, Value
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


class Stages(NamedTuple):
    """Registers of the catch stage and the test stage.

    Parameters
    ----------
    caught
        Catch: the request of the cycle before.
    mask
        Catch: pixels to draw; none without ``draw``.
    addresses
        Test: addresses of the two words.
    draws
        Test: pixels to draw or to clear.
    not_even
        Test: pixels not in the even word.
    odd
        Test: pixels in the odd word.
    before
        Test: the depth that is compared; 0 for a clear.
    depth, colour
        Test: what is written.
    """

    caught: Value
    mask: Value
    addresses: Value
    draws: Value
    not_even: Value
    odd: Value
    before: Value
    depth: Value
    colour: Value


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
        columns = range(config.pixels_per_word)
        stages = self._stages(m)
        kept = self._keep(m)
        written = Signal(data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word)))
        hazards = self._meet(m, stages.caught, stages.addresses, written)
        blank = {"depth": [config.background_depth for _ in columns]}
        leaving = Signal(
            BeatWordsLayout(config), init=dict.fromkeys(HALVES, blank), reset_less=True
        )
        m.d.comb += self.leaving.eq(leaving)
        for column in columns:
            olds, writes = {}, {}
            for half in HALVES:
                read, writes[half] = self._memory(m, half, column, stages)
                self._leave(m, half, column, read.data, leaving, kept)
                olds[half] = self._read(m, f"{half}_{column}", read.data, stages.caught)
            self._test(m, column, stages, hazards, olds, writes, written)
        return m

    def _stages(self, m):
        """Return the registers of the catch and test stages.

        A clear draws background into both words, whatever is there. Registers without a reset: the
        set and reset inputs of their flip-flops are used for the clear.
        """
        config, request = self.config, self.request
        background = config.background_depth
        caught = Signal(RowRequestLayout(config))
        mask = Signal(config.pixels_per_word, reset_less=True)  # of what is drawn
        addresses = Signal.like(caught.addresses, name="addresses")
        draws = Signal(config.pixels_per_word, init=-1, reset_less=True)
        not_even = Signal(config.pixels_per_word, reset_less=True)
        odd = Signal(config.pixels_per_word, init=-1, reset_less=True)
        before = Signal(config.depth_bits, reset_less=True)  # the depth that is compared
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
        return Stages(caught, mask, addresses, draws, not_even, odd, before, depth, colour)

    def _keep(self, m):
        """Return which pixels that are read are not flushed."""
        words = data.StructLayout(dict.fromkeys(HALVES, self.config.pixels_per_word))
        kept = Signal(words, reset_less=True)
        for half in HALVES:
            m.d.sync += [
                keep.eq(Mux(outside, 1, ~self.request.clear))
                for keep, outside in zip(
                    getattr(kept, half), getattr(self.outside, half), strict=True
                )
            ]
        return kept

    def _memory(self, m, half, column, stages):
        """Add a memory; return its read port and its write port."""
        ram = memory.Memory(
            shape=PixelLayout(self.config),
            depth=1 << row_address_bits(self.config),
            init=[],
            # Nobody uses a pixel that was read while it was being written.
            attrs={"ram_style": "block", "no_rw_check": 1},
        )
        m.submodules[f"{half}_{column}"] = ram
        read, load, write = ram.read_port(), ram.write_port(), ram.write_port()
        address, loaded = getattr(self.request.addresses, half), getattr(self.loaded, half)
        m.d.comb += [
            read.addr.eq(address),
            load.addr.eq(address),  # of the same address: the two are one port of the block RAM
            load.en.eq(self.request.load),
            load.data.depth.eq(loaded.depth[column]),
            load.data.colour.eq(loaded.colour[column]),
            write.addr.eq(getattr(stages.addresses, half)),
            write.data.depth.eq(stages.depth),
            write.data.colour.eq(stages.colour),
        ]
        return read, write

    def _leave(self, m, half, column, pixel, leaving, kept):
        """Set a flushed pixel; it is background unless it is cleared."""
        word, keep = getattr(leaving, half), getattr(kept, half)[column]
        m.d.sync += [
            word.depth[column].eq(Mux(keep, self.config.background_depth, pixel.depth)),
            word.colour[column].eq(Mux(keep, 0, pixel.colour)),
        ]

    def _read(self, m, name, pixel, caught):
        """Return the depth that was read; it is background where the pixel is cleared."""
        background = self.config.background_depth
        old = Signal(self.config.depth_bits, name=f"old_{name}", init=background, reset_less=True)
        m.d.sync += old.eq(Mux(caught.clear, background, pixel.depth))
        return old

    def _test(self, m, column, stages, hazards, olds, writes, written):
        """Compare depths, and write the pixel of a column in one of its two words, or in both.

        Not ``<``: in this order the choice of the word is in the LUTs of the carry chain. The bit
        above the depths is the same on both sides and changes nothing, unless the pixel was written
        two cycles before. Then it alone decides.
        """
        caught, mask, _, draws, not_even, odd, before, *_ = stages
        hidden, twice, behind = hazards
        meets = Mux(odd[column], twice.odd[column], twice.even[column])
        other = Mux(odd[column], olds["odd"], olds["even"])
        difference = Signal(self.config.depth_bits + 2, name=f"difference_{column}")
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
        m.d.sync += [
            twice.eq(again),
            # Of a clear without a draw it may be undefined, and would make the clear's sum so.
            behind.eq(caught.behind[1] & ~caught.clear),
        ]
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
