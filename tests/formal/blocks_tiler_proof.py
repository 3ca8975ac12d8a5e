"""The tiler of blocks against the contract: an element's block has its pixels, each once."""

from amaranth.hdl import Cat, Signal

from splatline.contract.config import BLOCK, ROWS
from splatline.rtl.blocks.tiler import BlockTiler
from splatline.rtl.layouts import sum_bits
from tests.formal.blocks_window_proof import comes_to_top, lines_are_there
from tests.formal.plane_words import give_plane, plane_covers, plane_sum
from tests.formal.properties import SWIFT_NINE
from tests.formal.prove import Fault, Proof
from tests.formal.tiles_tiler_proof import TilerProperties
from tests.formal.window_properties import Narrow

__all__ = ["PROOFS"]


class BlockTilerProperties(TilerProperties):
    """Any one pixel of any one place in the window: the elements that cover it, in order.

    As of tiles. And what the window counts on of blocks without a pixel as well: their lines are
    there, and an end token is offered at once.
    """

    tiler = BlockTiler
    inside = 4

    def describe(self, m):
        """Add the tiler and its properties."""
        super().describe(m)
        block = self.dut.o.payload
        top, passed = (Signal.like(block.top, name=name, init=-ROWS) for name in ("now", "passed"))
        offered, given = self.dut.o.valid, self.dut.o.valid & self.dut.o.ready
        waited = Signal()
        m.d.sync += [top.eq(block.top), waited.eq(offered & ~given)]
        with m.If(given):
            m.d.sync += passed.eq(block.top)
            with m.If(block.end):
                m.d.sync += [top.eq(-ROWS), passed.eq(-ROWS)]
        for row, touch in enumerate(block.touch):
            mask, odd = block.mask[row], block.odd[row]
            touches = touch == Cat((mask & odd).any(), (mask & ~odd).any())
            self.always(m, f"touch_{row}", ~offered | touches)
            self.always(m, f"rows_{row}", ~offered | (block.rows[row] == mask.any()))
            lower = (row - block.top[:3])[2]
            self.always(m, f"mode_{row}", ~(offered & block.mode & lower) | ~mask.any())
        self.given(m, "comes", comes_to_top(m, self.dut, offered, top))
        there = lines_are_there(m, self.config, self.dut, block, top)
        self.always(m, "there", ~offered | waited | block.end | there)
        self.always(m, "end_at_once", ~(offered & block.end & ~waited) | (top == passed))

    def _settle(self, m, draws, slot, oldest):
        """Assert nothing more of a pixel than of its block."""

    def _meet(self, m, tile, both):
        """Blocks may follow each other into any pixel."""

    def _second(self, block, row, column):
        """Return whether a pixel of a block lies in the second of its words."""
        return block.odd[row].bit_select(column, 1) ^ block.words[0][0]


class PlaneBlockTilerProperties(BlockTilerProperties):
    """The pixels of plane words, each with the sum of its own place."""

    def _assume(self, m, taken, given):
        """Assume of elements, their planes and the window what they are."""
        give_plane(m, self.config, self.dut.i.payload)
        return super()._assume(m, taken, given)

    def _covers(self, m, element, row, column):
        """Return whether an element has the pixel, by the contract."""
        return plane_covers(element, row, column)

    def _depth(self, m, element, row, column):
        """Return the sum of an element's pixel, by the contract."""
        return plane_sum(m, self.config, element, row, column)[: sum_bits(self.config)]

    def _drawn_depth(self, m, block, slot, column):
        """Return the sum of a block's pixel: of its line's share and its column's."""
        line = block.lines[slot[: BLOCK.bit_length() - 1]]
        total = Signal(sum_bits(self.config))
        m.d.comb += total.eq(line + block.columns[column[: self.config.pixel_bits]])
        return total


SMALL = Narrow(
    window="blocks",
    raster_words=2,
    pixels_per_word=8,
    x_bits=5,
    line_bits=6,
    depth_bits=3,
    plane=True,
    slope_bits=1,
)
"""Four words of eight pixels a line, and an image of up to 64 lines."""

PROOFS = [
    Proof(
        name="block tiler: pixels",
        shows="an element's block has the contract's pixels, each once, in order, in the window",
        build=lambda: BlockTilerProperties(SWIFT_NINE),
        depth=9,
        engine="abc bmc3",
        slow=True,
        long=True,
        faults=(
            Fault(
                "right border",
                BlockTiler,
                r"words_left >= word",
                "words_left + 1 >= word",
                "_shape",
            ),
            Fault("bottom border", BlockTiler, r"\[:3\] >= q", "[:3] + 1 >= q", "_lines"),
            Fault("a line misplaced", BlockTiler, r" \+ \(top\[:3\] > q\)", "", "_lines"),
            Fault("not turned", BlockTiler, r"mask\[::-1\] for", "mask for", "_shape"),
            Fault(
                "not raised",
                BlockTiler,
                r"Mux\(shape\.raised, high, low\)",
                "low",
                "_shape",
            ),
            Fault("not shifted", BlockTiler, r"\(0, shape\.shifted\)", "(0, 0)", "_turn"),
            Fault(
                "the middle drawn twice",
                BlockTiler,
                r"\*turned\[1:\], 0\]",
                "*turned[1:], turned[3]]",
                "_shape",
            ),
            Fault(
                "a fraction's lower half",
                BlockTiler,
                r" & whole",
                "",
                "_shape",
            ),
            Fault(
                "the other half's words",
                BlockTiler,
                r"Mux\(row\[2\], turned\.odd\[1\], turned\.odd\[0\]\)",
                "turned.odd[0]",
                "_lay",
            ),
            Fault(
                "not yet the next frame's window",
                BlockTiler,
                r"with m\.If\(offered & last\.end\)",
                "with m.If(0)",
            ),
            Fault("turned too far", BlockTiler, r"first\.rotate_left\(1\)", "first", "_shape"),
            Fault("in the window's last line", BlockTiler, r"> BLOCK\b", ">= BLOCK"),
            Fault(
                "the element behind it",
                BlockTiler,
                r"Mux\(waiting, top, lanes\.top\)",
                "lanes.top",
            ),
            Fault(
                "over what is cleared",
                BlockTiler,
                r" & ~\(self\.cleared\.valid & [^\n]+\)",
                ")",
            ),
            Fault("over what leaves", BlockTiler, r" & _outside\(behind\[:bits\], mode\)", ""),
            Fault("coming to another", BlockTiler, r"self\.empties & waiting", "self.empties"),
            Fault("a fraction of the one before", BlockTiler, r"waiting & last\.mode", "last.mode"),
            Fault("empty, and no end in sight", BlockTiler, r"\(near \| last\.end\)", "1"),
        ),
    ),
    Proof(
        name="block tiler: planes",
        shows="an element's block has the contract's pixels, each once, with the sum of its place",
        build=lambda: PlaneBlockTilerProperties(SMALL),
        depth=8,
        engine="abc bmc3",
        slow=True,
        long=True,
        faults=(
            Fault("no Z", BlockTiler, r" \+ \(lanes\.z << 1\)", ""),
            Fault("the row of another line", BlockTiler, r"q - top\[:3\]", "q - top[:2]", "_lay"),
            Fault("the row above", BlockTiler, r"plane\.down \* row", "plane.down * (row - 1)[:3]",
                  "_lay"),
            Fault("the lane's own column", BlockTiler, r"p - turned\.x\[:bits\]", "p", "_lay"),
            Fault("slopes exchanged", BlockTiler, r"plane\.across", "plane.down", "_lay"),
            Fault("leaves the block", BlockTiler, r"\[: BLOCK - 2\], 1\)", "[: BLOCK - 1])",
                  "_half_turns"),
            Fault("moved the other way", BlockTiler, r"outwards, inwards", "inwards, outwards",
                  "_half_turns"),
            Fault("an empty row's half turn", BlockTiler, r" & shape\.filled\[k\]", "",
                  "_half_turns"),
        ),
    ),
]  # fmt: skip
