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

    ``draw``: depth-test the pixels of ``mask``; those in ``odd`` lie in the odd word. ``store`` and
    ``clear``: read both words and leave background there. ``store`` alone is a load: write a pixel
    of each column into the odd word, or with ``both`` into both words, without a depth test;
    ``mask`` and ``odd`` are all ones. A ``draw`` with an empty mask may come with a clear.
    ``again`` of the next draws then means nothing.

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
                "store": 1,
                "clear": 1,
                "both": 1,
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
    new
        Catch: the depth to draw in each column.
    depth
        Test: the depth that is compared and written in each column.
    colour
        Test: the colour that is written in each column.
    """

    caught: Value
    mask: Value
    addresses: Value
    draws: Value
    not_even: Value
    odd: Value
    new: list[Value]
    depth: list[Value]
    colour: list[Value]


class LaneRow(wiring.Component):
    """Reads a pixel of each column, compares depths, and writes the new pixel if it is nearer.

    Each column has a memory for the even words and one for the odd words of its lines. A memory
    word is one pixel, so a write need not merge anything with the old word. An element has at most
    one pixel of a column, in one of the two memories, so they share a comparison. The LUTs of the
    comparison have an input to spare for the choice. All memories of a half have one address.

    The pipeline has three stages. *Read*: the memory reads, in the cycle of the request. *Catch*:
    the pixel is registered. *Test*: depths are compared, and the pixel is written at the end of the
    cycle. A clear and a load pass the comparison, whatever was read.

    Read-after-write hazards: a pixel is read before the request of the cycle before has written
    it, and while the request of two cycles before writes it, so its value may be undefined. No
    pixel is forwarded, because depth is constant within an element (decision 0029). If the request
    of two cycles before has written the pixel, the new one passes exactly if its element is nearer
    than that one's. If the request of the cycle before writes the pixel, the new one is compared
    with the old value and is written a cycle later; it is ``hidden`` unless its element is nearer
    than that one's.

    A pixel that is read for a clear goes to a register, which is background otherwise. The readout
    joins the registers of all rows without a multiplexer.

    One port of a memory reads and the other writes: only so is a block RAM of an ECP5 36 bits wide.

    The row never stalls: the requester of a clear must have room for the word.

    **Latency**: 2 cycles to ``leaving``, 3 to the memory. A line may be drawn into three cycles
    after a clear in it, and loaded in the next. A pixel may be cleared three cycles after a draw or
    a load, and drawn three cycles after a load. **Throughput**: one request a cycle.

    Members
    -------
    request : In(RowRequestLayout)
        The request.
    new : In(pixels_per_word x PixelLayout)
        The pixel to draw or to load in each column, in the cycle after the request. A draw has the
        same depth in all columns.
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
                **self._shares(),
                "new": In(data.ArrayLayout(PixelLayout(config), config.pixels_per_word)),
                "outside": In(data.StructLayout(dict.fromkeys(HALVES, config.pixels_per_word))),
                "leaving": Out(BeatWordsLayout(config)),
            }
        )

    def _shares(self):
        """Return the members that depths come from, beside ``new``."""
        return {}

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
                olds[half] = self._read(m, f"{half}_{column}", read.data)
            self._test(m, column, stages, hazards, olds, writes, written)
        return m

    def _stages(self, m):
        """Return the registers of the catch and test stages.

        A clear draws background into both words, whatever is there. Registers without a reset: the
        set and reset inputs of their flip-flops are used for the clear, and for a load.
        """
        config, request = self.config, self.request
        columns = range(config.pixels_per_word)
        caught = Signal(RowRequestLayout(config))
        mask = Signal(config.pixels_per_word, reset_less=True)  # of what is drawn or loaded
        addresses = Signal.like(caught.addresses, name="addresses")
        draws = Signal(config.pixels_per_word, init=-1, reset_less=True)
        not_even = Signal(config.pixels_per_word, reset_less=True)
        odd = Signal(config.pixels_per_word, init=-1, reset_less=True)
        m.d.sync += [
            caught.eq(request),
            mask.eq(Mux(request.draw | request.store, request.mask, 0)),
            addresses.eq(caught.addresses),
            not_even.eq(Mux(caught.clear | caught.both, 0, caught.odd)),
            odd.eq(Mux(caught.clear, -1, caught.odd)),
        ]
        background = config.background_depth
        new = self._depths(m)
        depth = [
            Signal(config.depth_bits, name=f"depth_{column}", init=background, reset_less=True)
            for column in columns
        ]
        colour = [
            Signal(config.colour_bits, name=f"colour_{column}", reset_less=True)
            for column in columns
        ]
        for column in columns:
            m.d.sync += [
                depth[column].eq(Mux(caught.clear, background, new[column])),
                colour[column].eq(Mux(caught.clear, 0, self.new[column].colour)),
            ]
        return Stages(caught, mask, addresses, draws, not_even, odd, new, depth, colour)

    def _depths(self, m):
        """Return the depth to draw in each column, in the cycle after the request."""
        return [pixel.depth for pixel in self.new]

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
        read = ram.read_port()
        write = ram.write_port()
        m.d.comb += [
            read.addr.eq(getattr(self.request.addresses, half)),
            write.addr.eq(getattr(stages.addresses, half)),
            write.data.depth.eq(stages.depth[column]),
            write.data.colour.eq(stages.colour[column]),
        ]
        return read, write

    def _leave(self, m, half, column, pixel, leaving, kept):
        """Set a flushed pixel; it is background unless it is cleared."""
        word, keep = getattr(leaving, half), getattr(kept, half)[column]
        m.d.sync += [
            word.depth[column].eq(Mux(keep, self.config.background_depth, pixel.depth)),
            word.colour[column].eq(Mux(keep, 0, pixel.colour)),
        ]

    def _read(self, m, name, pixel):
        """Return the depth that was read; it means nothing where the pixel is cleared or loaded."""
        old = Signal(self.config.depth_bits, name=f"old_{name}", reset_less=True)
        m.d.sync += old.eq(pixel.depth)
        return old

    def _test(self, m, column, stages, hazards, olds, writes, written):
        """Compare depths, and write the pixel of a column; a clear writes it in both words.

        A subtraction and not ``<``: the LUTs of its carry chain also choose the word. The bit above
        the depths is equal on both sides, unless the pixel was written two cycles before, or is
        cleared or loaded. Then it alone decides.
        """
        caught, mask, _, draws, not_even, odd, _, depth, _ = stages
        hidden, twice, behind = hazards
        meets = Mux(odd[column], twice.odd[column], twice.even[column])
        other = Mux(odd[column], olds["odd"], olds["even"])
        difference = Signal(self.config.depth_bits + 2, name=f"difference_{column}")
        passes = Signal(name=f"passes_{column}")
        m.d.sync += draws[column].eq(Mux(caught.clear, 1, mask[column]))
        m.d.comb += [
            difference.eq(Cat(depth[column], behind) - Cat(other, behind ^ meets)),
            passes.eq(difference[-1] & draws[column]),
            written.even[column].eq(passes & ~not_even[column] & ~hidden.even[column]),
            written.odd[column].eq(passes & odd[column] & ~hidden.odd[column]),
            writes["even"].en.eq(written.even[column]),
            writes["odd"].en.eq(written.odd[column]),
        ]

    def _meet(self, m, stages, written):
        """Find read-after-write hazards of the pixels in the test stage.

        ``hidden``: a nearer element wrote the pixel one cycle before. ``twice``: an element wrote
        it two cycles before, or it is cleared or loaded. ``behind``: the element of two cycles
        before is nearer, or as near; nothing is, if the pixel is cleared or loaded.
        """
        caught, words = stages.caught, written.shape()
        hidden, again, twice = (
            Signal(words, name=name, reset_less=True) for name in ("hidden", "again", "twice")
        )
        behind = Signal(reset_less=True)
        m.d.sync += behind.eq(~caught.store & caught.behind[1])
        for half in HALVES:
            now, then, last = self._groups(half, stages)
            hides = getattr(caught.again[0], half) & caught.behind[0] & (then == last)
            meets = getattr(self.request.again[1], half) & (now == last)
            there = getattr(written, half)
            m.d.sync += [
                getattr(hidden, half).eq(Mux(hides & ~caught.store, there, 0)),
                getattr(again, half).eq(Mux(meets, there, 0)),
                getattr(twice, half).eq(Mux(caught.store, -1, getattr(again, half))),
            ]
        return hidden, twice, behind

    def _groups(self, half, stages):
        """Return the groups of the lines of the last three requests, the latest first."""
        requests = (self.request.addresses, stages.caught.addresses, stages.addresses)
        return (getattr(place, half)[self.config.word_bits - 1 :] for place in requests)
