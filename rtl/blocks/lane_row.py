"""A row of lanes of the blocks engine: the pixels of every eighth line."""

from typing import NamedTuple

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import PixelLayout, WordLayout, sum_bits

__all__ = ["HALVES", "BeatWordsLayout", "LaneRow", "RowRequestLayout", "row_address_bits"]

HALVES = ("even", "odd")
"""The two kinds of window words: of even and of odd number in their line."""


def row_address_bits(config: EngineConfig) -> int:
    """Return the address bits of a row's memories: of its lines, and of half of their words."""
    return config.group_bits + config.word_bits - 1


class BeatWordsLayout(data.StructLayout):
    """The two words of a beat."""

    def __init__(self, config: EngineConfig):
        super().__init__(dict.fromkeys(HALVES, WordLayout(config)))


class RowRequestLayout(data.StructLayout):
    """A request to a row of lanes, at most one of three operations.

    ``draw``: depth-test the pixels of ``mask``; those in ``odd`` lie in the odd word. ``clear``:
    read both words and leave background there. ``load``: write a beat there without a depth test.
    A ``draw`` with an empty mask may come with another operation. ``again`` of the next draws then
    means nothing.

    ``addresses``: addresses of the even and the odd word. ``again``: the block drawn one cycle
    before, and two cycles before, has the same even or odd word; the group of the line is not
    compared. ``behind``: that block is nearer than this one, or as near. With planes there is
    ``line`` instead, the line's share of the pixels' depths (see :class:`BlockLayout`).
    """

    def __init__(self, config: EngineConfig):
        address = row_address_bits(config)
        depth = {"line": signed(sum_bits(config))} if config.plane else {"behind": 2}
        super().__init__(
            {
                "draw": 1,
                "clear": 1,
                "load": 1,
                "mask": config.pixels_per_word,
                "odd": config.pixels_per_word,
                "addresses": data.StructLayout(dict.fromkeys(HALVES, address)),
                "again": data.ArrayLayout(data.StructLayout(dict.fromkeys(HALVES, 1)), 2),
                **depth,
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
        Test: the depth that is compared; 0 for a clear. With planes Catch: the depth to draw in
        each column.
    depth
        Test: the depth that is written in each column.
    colour
        Test: the colour that is written.
    """

    caught: Value
    mask: Value
    addresses: Value
    draws: Value
    not_even: Value
    odd: Value
    before: Value
    depth: list[Value]
    colour: Value


class LaneRow(wiring.Component):
    """Reads a pixel of each column, compares depths, and writes the new pixel if it is nearer.

    Each column has a memory for the even words and one for the odd words of its lines. A memory
    word is one pixel, so a write need not merge anything with the old word. An element has at most
    one pixel of a column, in one of the two memories, so they share a comparison. The LUTs of the
    comparison have an input to spare for the choice. All memories of a half have one address.

    The pipeline has three stages. *Read*: the memory reads, in the cycle of the request. *Catch*:
    the pixel is registered. *Test*: depths are compared, and the pixel is written at the end of the
    cycle.

    Read-after-write hazards: a pixel is read before the request of the cycle before has written
    it, and while the request of two cycles before writes it, so its value may be undefined. No
    pixel is forwarded, because depth is constant within an element (decision 0029). If the request
    of two cycles before has written the pixel, the new one passes exactly if its element is nearer
    than that one's. If the request of the cycle before writes the pixel, the new one is compared
    with the old value and is written a cycle later; it is ``hidden`` unless its element is nearer
    than that one's.

    A pixel that is read for a clear goes to a register, which is background otherwise. The readout
    joins the registers of all rows without a multiplexer.

    A load goes through the read port, which is otherwise unused in that cycle. It needs no
    multiplexer. The other port may write at the same time, but not the same pixel.

    The row never stalls: the requester of a clear must have room for the word.

    **Latency**: 2 cycles to ``leaving``, 3 to the memory, 1 for a load. A line may be drawn into or
    loaded three cycles after a clear in it, and a pixel may be cleared three cycles after a draw.
    **Throughput**: one request a cycle.

    Members
    -------
    request : In(RowRequestLayout)
        The request.
    new : In(PixelLayout)
        The pixel to draw, in the cycle after the request.
    loaded : In(BeatWordsLayout)
        The beat to load, in the cycle of the request.
    outside : In(2 x pixels_per_word)
        Pixels of the requested beat that leave as background, in the cycle of the request.
    leaving : Out(BeatWordsLayout)
        The words cleared by the request of two cycles before, as they were; else background.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "request": In(RowRequestLayout(config)),
                **self._new(),
                "loaded": In(BeatWordsLayout(config)),
                "outside": In(data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word))),
                "leaving": Out(BeatWordsLayout(config)),
            }
        )

    def _new(self):
        """Return the members that give what is drawn."""
        return {"new": In(PixelLayout(self.config))}

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        columns = range(config.pixels_per_word)
        stages = self._stages(m)
        kept = self._keep(m)
        written = Signal(data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word)))
        hazards = self._meet(m, stages, written)
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
        caught = Signal(RowRequestLayout(config))
        mask = Signal(config.pixels_per_word, reset_less=True)  # of what is drawn
        addresses = Signal.like(caught.addresses, name="addresses")
        draws = Signal(config.pixels_per_word, init=-1, reset_less=True)
        not_even = Signal(config.pixels_per_word, reset_less=True)
        odd = Signal(config.pixels_per_word, init=-1, reset_less=True)
        m.d.sync += [
            caught.eq(request),
            mask.eq(Mux(request.draw, request.mask, 0)),
            addresses.eq(caught.addresses),
            not_even.eq(Mux(caught.clear, 0, caught.odd)),
            odd.eq(Mux(caught.clear, -1, caught.odd)),
        ]
        before, depth = self._depths(m, caught)
        colour = Signal(config.colour_bits, reset_less=True)
        m.d.sync += colour.eq(Mux(caught.clear, 0, self.new.colour))
        return Stages(caught, mask, addresses, draws, not_even, odd, before, depth, colour)

    def _depths(self, m, caught):
        """Return the depth that is compared, and the one that is written in each column."""
        config = self.config
        background = config.background_depth
        before = Signal(config.depth_bits, reset_less=True)
        depth = Signal(config.depth_bits, init=background, reset_less=True)
        m.d.sync += [
            before.eq(Mux(caught.clear, 0, self.new.depth)),
            depth.eq(Mux(caught.clear, background, self.new.depth)),
        ]
        return before, [depth] * config.pixels_per_word

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
            write.data.depth.eq(stages.depth[column]),
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
        """Compare depths, and write the pixel of a column; a clear writes it in both words.

        A subtraction and not ``<``: the LUTs of its carry chain also choose the word. The bit above
        the depths is equal on both sides, unless the pixel was written two cycles before. Then it
        alone decides.
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

    def _meet(self, m, stages, written):
        """Find read-after-write hazards of the pixels in the test stage.

        ``hidden``: a nearer element wrote the pixel one cycle before. ``twice``: an element wrote
        it two cycles before. ``behind``: the element of two cycles before is nearer, or as near.
        """
        caught, words = stages.caught, written.shape()
        hidden, again, twice = (
            Signal(words, name=name, reset_less=True) for name in ("hidden", "again", "twice")
        )
        behind = Signal(reset_less=True)
        m.d.sync += [twice.eq(again), behind.eq(caught.behind[1])]
        for half in HALVES:
            now, then, last = self._groups(half, stages)
            hides = getattr(caught.again[0], half) & caught.behind[0] & (then == last)
            meets = getattr(self.request.again[1], half) & (now == last)
            there = getattr(written, half)
            m.d.sync += [
                getattr(hidden, half).eq(Mux(hides & ~caught.clear, there, 0)),
                getattr(again, half).eq(Mux(meets & ~self.request.clear, there, 0)),
            ]
        return hidden, twice, behind

    def _groups(self, half, stages):
        """Return the groups of the lines of the last three requests, the latest first."""
        requests = (self.request.addresses, stages.caught.addresses, stages.addresses)
        return (getattr(place, half)[self.config.word_bits - 1 :] for place in requests)
