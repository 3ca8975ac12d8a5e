"""The tiler against the contract: an element's tiles have its pixels, each once."""

from itertools import pairwise

from amaranth.hdl import Cat, Const, Mux, Signal
from amaranth.lib import data

from splatline.contract.config import BLOCK
from splatline.contract.presets import PAPER
from splatline.rtl.tiles.tiler import Tiler
from tests.formal.properties import Properties, any_constant, covers
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS", "TilerProperties"]


class TilerProperties(Properties):
    """Any one pixel of any one place in the window: the elements that cover it, in order.

    Every element that has the pixel by the contract puts its depth into a queue, and every tile
    that draws it must take out that depth: so it is drawn as often as it is to be, and not more.
    """

    tiler = Tiler
    """What is proven."""

    inside = 2
    """Elements that it holds at most."""

    def __init__(self, config):
        self.config = config

    def describe(self, m):
        """Add the tiler and its properties."""
        config = self.config
        m.submodules.dut = self.dut = dut = self.tiler(config)
        last_column = any_constant(m, config.x_bits, "last_column")
        last_line = any_constant(m, config.line_bits, "last_line")
        slot = any_constant(m, config.slot_bits, "slot")
        column = any_constant(m, config.x_bits, "column")
        self.free(m, dut, last_column=last_column, last_line=last_line)
        element, tile = dut.i.payload, dut.o.payload
        taken, given = dut.i.valid & dut.i.ready, dut.o.valid & dut.o.ready
        oldest, ended = self._assume(m, taken, given)
        # The line of the element's block that has the place, if there is one.
        row = Signal(config.slot_bits)
        line = Signal.like(element.top)
        m.d.comb += [row.eq(slot - element.top), line.eq(element.top + row)]
        wanted = Signal()
        m.d.comb += wanted.eq(
            taken
            & (row < 8)
            & self._covers(m, element, row, column)
            & (line >= 0)
            & (line <= last_line)
            & (column[config.pixel_bits :] <= last_column[config.pixel_bits :])
        )
        draws, drawn = self._draws(m, slot, column)
        depths = self._depth(m, element, row, column), self._drawn_depth(m, tile, slot, column)
        self._match(m, wanted, taken, draws, drawn, given, depths)
        shown = Signal.like(tile.top, init=-4)
        m.d.sync += shown.eq(Mux(given & tile.end, -4, tile.top))
        self.always(m, "top", tile.top >= shown)
        self.always(m, "behind_the_end", ~(ended & dut.o.valid) | tile.end)
        place = Signal(config.slot_bits)
        distance = Signal.like(element.top)
        m.d.comb += [
            place.eq(slot - dut.oldest),
            distance.eq(dut.oldest + place - tile.top),
        ]
        self.always(m, "in_window", ~draws | ((distance >= 0) & (distance < 8)))
        self._settle(m, draws, slot, oldest)
        drew = Signal()
        m.d.sync += drew.eq(drawn)
        self._meet(m, tile, drew & draws)
        self.always(m, "output_steady", self.steady(m, dut.o, "o"))

    def _covers(self, m, element, row, column):
        """Return whether an element has the pixel, by the contract."""
        return covers(element, row, column)

    def _depth(self, m, element, row, column):
        """Return the depth of an element's pixel, by the contract."""
        return element.z

    def _drawn_depth(self, m, tile, slot, column):
        """Return the depth of a tile's pixel."""
        return tile.z

    def _assume(self, m, taken, given):
        """Assume of elements and window what they are.

        Return the window's first line, and whether an end token was given, a cycle before.
        """
        config, dut = self.config, self.dut
        element, tile = dut.i.payload, dut.o.payload
        lowest = (1 << len(element.top) - 1) - 1
        # Elements are sorted, and those of the next frame follow right behind the end of one.
        top = Signal.like(element.top, name="last_top", init=-4)
        with m.If(taken):
            m.d.sync += top.eq(Mux(element.end, -4, element.top))
        oldest = Signal.like(dut.oldest)
        ended = Signal()  # in the cycle before an end token was given
        m.d.sync += [oldest.eq(dut.oldest), ended.eq(given & tile.end)]
        self.given(m, "steady", self.steady(m, dut.i, "i"))
        self.given(m, "sorted", ~dut.i.valid | (element.top >= top))
        self.given(m, "end_top", ~dut.i.valid | ~element.end | (element.top == lowest))
        # The window moves on, no further than the elements, and lies before the frame when the one
        # before has ended.
        anew = (dut.oldest <= 0) & (dut.oldest >= -2 * config.window_lines)
        # Before the frame, where no line of it is in the window, it may lie anywhere.
        lines = config.window_lines - (config.window_lines > BLOCK)  # that are drawn into
        back = (oldest <= -lines) & (dut.oldest >= -2 * config.window_lines)
        goes_on = (dut.oldest >= oldest) | back
        self.given(m, "oldest", Mux(ended, anew, goes_on))
        self.given(m, "not_past", (dut.oldest <= 0) | (dut.oldest <= tile.top))
        return oldest, ended

    def _draws(self, m, slot, column):
        """Return whether the tile draws the pixel, and whether it is taken."""
        config, dut = self.config, self.dut
        tile = dut.o.payload
        number = column[: config.pixel_bits]
        hits = []
        for q in range(config.tile_lines):
            place = Cat(Const(q, config.slot_bits - config.group_bits), tile.group[q])
            word = tile.words[self._second(tile, q, number)]
            hits.append(
                (place == slot)
                & tile.mask[q].bit_select(number, 1)
                & (word == column[config.pixel_bits :])
            )
        draws, drawn = Signal(), Signal()
        m.d.comb += [
            draws.eq(dut.o.valid & Cat(hits).any()),
            drawn.eq(draws & dut.o.ready),
        ]
        return draws, drawn

    def _match(self, m, wanted, taken, draws, drawn, given, depths):
        """Assert that tiles draw the elements that want the pixel, each once, in order.

        End tokens are in the queue as well. One more may be taken in the cycle that gives another.
        ``depths``: that of the element's pixel, and that of the tile's.
        """
        dut = self.dut
        element, tile = dut.i.payload, dut.o.payload
        depth, drawn_depth = depths
        most = self.inside + 1
        entry = data.StructLayout({"depth": depth.shape(), "end": 1})
        queue = [Signal(entry, name=f"queue_{n}") for n in range(most)]
        length = Signal(range(most + 1))
        comes, goes = Signal(), Signal()
        m.d.comb += [
            comes.eq(wanted | (taken & element.end)),
            goes.eq(drawn | (given & tile.end)),
        ]
        with m.If(goes):
            m.d.sync += [place.eq(after) for place, after in pairwise(queue)]
        for n in range(most):
            with m.If(comes & (length - goes == n)):
                m.d.sync += [queue[n].depth.eq(depth), queue[n].end.eq(element.end)]
        m.d.sync += length.eq(length + comes - goes)
        first = queue[0]
        self.always(m, "room", length < most)
        same = (length != 0) & ~first.end & (drawn_depth == first.depth)
        self.always(m, "drawn", ~draws | same)
        self.always(m, "complete", ~(dut.o.valid & tile.end) | ((length != 0) & first.end))

    def _settle(self, m, draws, slot, oldest):
        """Assert that a pixel is in the window as it was a cycle ago.

        For the word that left is still being cleared.
        """
        config, top = self.config, self.dut.o.payload.top
        place = Signal(config.slot_bits, name="place_before")
        distance = Signal.like(top, name="before")
        m.d.comb += [place.eq(slot - oldest), distance.eq(oldest + place - top)]
        self.always(m, "settled", ~draws | ((distance >= 0) & (distance < 8)))
        # Nor in the last line of a window of more than eight, of which words may still be loaded.
        lines = config.window_lines - (config.window_lines > BLOCK)
        self.always(m, "not_the_last", ~draws | (distance + top < oldest + lines))

    def _meet(self, m, tile, both):
        """Assert that a tile says so where it draws the pixel that was drawn a cycle before."""
        self.always(m, "meets", ~both | tile.meets)

    def _second(self, tile, row, column):
        """Return whether a pixel of a tile lies in the second of its words."""
        return tile.next.bit_select(column, 1)


WORDS = [PAPER, PAPER.replace(pixels_per_word=2), PAPER.replace(pixels_per_word=8, window_lines=8)]

FAULTS = (
    Fault("right border", Tiler, r"words_left >= k", "words_left + 1 >= k", "_columns"),
    Fault("a tile lost", Tiler, r"left\.eq\(rest\)", "left.eq(0)"),
    Fault("a line misplaced", Tiler, r"past\.eq\(top\[:2\] > i\)", "past.eq(0)", "_lines"),
    Fault("not turned", Tiler, r"mask\[::-1\]", "mask", "_rows"),
    Fault("not raised", Tiler, r"lower & raised", "0"),
    Fault("not shifted", Tiler, r"lower & shifted", "0"),
    Fault("the middle drawn twice", Tiler, r"Mux\(raised, 0, other\)", "other", "_turn"),
    Fault("not yet the next frame's window", Tiler, r" \| \(valid & given\.end\)", ""),
    Fault("in the window's last line", Tiler, r"low > 2 \* SIDE", "low >= 2 * SIDE", "_compare"),
    Fault("never meets", Tiler, r"meets\.eq\(", "meets.eq(0 & ", "_give"),
)

PROOFS = [
    Proof(
        name=f"tiler: pixels, words of {config.pixels_per_word}",
        shows="an element's tiles have the contract's pixels, each once, in order, in the window",
        build=lambda config=config: TilerProperties(config),
        depth=7,
        engine="abc bmc3",
        slow=True,
        # The first two are of words; the others are in the same lines for any size of them.
        faults=FAULTS if config.pixels_per_word == PAPER.pixels_per_word else FAULTS[:2],
    )
    for config in WORDS
]
