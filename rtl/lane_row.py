"""A row of lanes: the pixels of every eighth line, for elements that are drawn in one cycle."""

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from .format import EngineConfig
from .lane import PixelLayout
from .layouts import WordLayout

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
    is. At most one of the three. ``addresses``: where the even word lies, and where the odd one.
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
            }
        )


class LaneRow(wiring.Component):
    """Reads a pixel a column, tests it, and writes over it if it is behind.

    Each column has a memory for the even words of its lines and one for the odd ones, a pixel a
    word of memory: so nothing need be merged with what was there. An element has a pixel of a
    column in one of the two at most, so they share the comparison, whose LUTs have an input to
    spare for the choice. All memories of a half have one address.

    A pixel is read in the cycle of the request; in the next it is compared with what is drawn, and
    what is written is written at that cycle's end. A request for that very pixel in that cycle
    would read it as it was before: whoever requests must wait a cycle.

    What is cleared is read into a register, which has background otherwise. So what leaves the
    window is what all rows have there together, and is not chosen from them.

    A beat is loaded through the port that reads, which has no other use for that cycle: so it takes
    no multiplexer, and the other port may write at the same time, but not the same pixel.

    Nothing ever stands still: whoever has a word cleared must have room for it.

    **Latency**: 2 cycles to ``leaving`` and to the memory, 1 for a load. **Throughput**: one
    request a cycle.

    Members
    -------
    request : In(RowRequestLayout)
        What to do.
    new : In(PixelLayout)
        What to draw, in the cycle of the request.
    loaded : In(BeatWordsLayout)
        What to load, in the cycle of the request.
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
        taken = Signal(RowRequestLayout(config))
        # Registers without a reset, as that is what they are set or cleared with for nothing.
        mask = Signal(config.pixels_per_word, reset_less=True)  # of what is drawn
        depth = Signal(config.depth_bits, init=background, reset_less=True)
        colour = Signal(config.colour_bits, reset_less=True)
        blank = {"depth": [background for _ in columns]}
        leaving = Signal(
            BeatWordsLayout(config), init=dict.fromkeys(HALVES, blank), reset_less=True
        )
        m.d.comb += self.leaving.eq(leaving)
        m.d.sync += [
            taken.eq(request),
            mask.eq(Mux(request.draw, request.mask, 0)),
            depth.eq(Mux(request.clear, background, self.new.depth)),
            colour.eq(Mux(request.clear, 0, self.new.colour)),
        ]
        for column in columns:
            ports = {}
            for half in HALVES:
                ram = memory.Memory(
                    shape=PixelLayout(config),
                    depth=1 << row_address_bits(config),
                    init=[],
                    # Nobody uses a pixel that was read while it was being written.
                    attrs={"ram_style": "block", "no_rw_check": 1},
                )
                m.submodules[f"{half}_{column}"] = ram
                ports[half] = read, load, write = (
                    ram.read_port(),
                    ram.write_port(),
                    ram.write_port(),
                )
                loaded = getattr(self.loaded, half)
                m.d.comb += [
                    read.addr.eq(getattr(request.addresses, half)),
                    # Of the same address: the two are one port of the block RAM.
                    load.addr.eq(getattr(request.addresses, half)),
                    load.en.eq(request.load),
                    load.data.depth.eq(loaded.depth[column]),
                    load.data.colour.eq(loaded.colour[column]),
                    write.addr.eq(getattr(taken.addresses, half)),
                    write.data.depth.eq(depth),
                    write.data.colour.eq(colour),
                ]
                word = getattr(leaving, half)
                m.d.sync += [
                    word.depth[column].eq(Mux(taken.clear, read.data.depth, background)),
                    word.colour[column].eq(Mux(taken.clear, read.data.colour, 0)),
                ]
            (even, _, write_even), (odd, _, write_odd) = ports.values()
            is_odd = taken.odd[column]
            # Not ``<``: in this order the choice rides on the LUTs of the carry chain.
            difference = Signal(config.depth_bits + 1, name=f"difference_{column}")
            passes = Signal(name=f"passes_{column}")
            m.d.comb += [
                difference.eq(depth - Mux(is_odd, odd.data.depth, even.data.depth)),
                passes.eq(difference[-1] & mask[column]),
                write_even.en.eq(taken.clear | (passes & ~is_odd)),
                write_odd.en.eq(taken.clear | (passes & is_odd)),
            ]
        return m
