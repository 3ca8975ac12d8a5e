"""The tiler of blocks against the contract: an element's block has its pixels, each once."""

from amaranth.hdl import Signal
from prove import Fault, Proof
from tiler_proof import TilerProperties

from splatline.rtl.block_tiler import BlockTiler
from splatline.rtl.format import BLOCK, ROWS
from splatline.rtl.variants import SWIFT_OF_LANES

__all__ = ["PROOFS"]


class BlockTilerProperties(TilerProperties):
    """Any one pixel of any one place in the window: the elements that cover it, in order.

    As of tiles. And what the window counts on of blocks without a pixel as well: they wait for
    their lines, and an end token is offered at once.
    """

    tiler = BlockTiler

    def describe(self, m):
        """Add the tiler and its properties."""
        super().describe(m)
        block, oldest = self.dut.o.payload, Signal.like(self.dut.oldest, name="oldest_then")
        top, passed = (Signal.like(block.top, name=name, init=-ROWS) for name in ("now", "passed"))
        offered, given = self.dut.o.valid, self.dut.o.valid & self.dut.o.ready
        waited = Signal()
        m.d.sync += [oldest.eq(self.dut.oldest), top.eq(block.top), waited.eq(offered & ~given)]
        with m.If(given):
            m.d.sync += passed.eq(block.top)
            with m.If(block.end):
                m.d.sync += [top.eq(-ROWS), passed.eq(-ROWS)]
        near = block.top - oldest < self.config.window_lines - BLOCK
        self.always(m, "near", ~offered | block.end | near)
        self.always(m, "end_at_once", ~(offered & block.end & ~waited) | (top == passed))

    def _second(self, block, row, column):
        """Return whether a pixel of a block lies in the second of its words."""
        return block.odd[row].bit_select(column, 1) ^ block.words[0][0]


PROOFS = [
    Proof(
        name="block tiler: pixels",
        shows="an element's block has the contract's pixels, each once, in order, in the window",
        build=lambda: BlockTilerProperties(SWIFT_OF_LANES),
        depth=7,
        engine="abc bmc3",
        slow=True,
        faults=(
            Fault(
                "right border",
                BlockTiler,
                r"words_left >= word",
                "words_left + 1 >= word",
                "_place",
            ),
            Fault("bottom border", BlockTiler, r"\[:3\] >= q", "[:3] + 1 >= q", "_lines"),
            Fault("a line misplaced", BlockTiler, r" \+ \(top\[:3\] > q\)", "", "_lines"),
            Fault("not turned", BlockTiler, r"mask\[::-1\] for", "mask for", "_place"),
            Fault(
                "not raised",
                BlockTiler,
                r"Mux\(shape\.raised, raised, turned\[k\]\)",
                "turned[k]",
                "_place",
            ),
            Fault("not shifted", BlockTiler, r"\(1, shifted\)", "(1, 0)", "_place"),
            Fault(
                "the middle drawn twice",
                BlockTiler,
                r"k \+ 1 < ROWS else 0",
                "k + 1 < ROWS else turned[k]",
                "_place",
            ),
            Fault(
                "a fraction's lower half",
                BlockTiler,
                r"Mux\(element\.mode, 0, lower\)",
                "lower",
                "_place",
            ),
            Fault(
                "the other half's words",
                BlockTiler,
                r"Mux\(row\[2\], halves\[1\], halves\[0\]\)",
                "halves[0]",
                "_place",
            ),
            Fault("not yet the next frame's window", BlockTiler, r" \| \(valid & given\.end\)", ""),
            Fault("in the window's last line", BlockTiler, r"> BLOCK\b", ">= BLOCK"),
            Fault(
                "the element behind it",
                BlockTiler,
                r"Mux\(waiting, held\[\"top\"\], element\.top\)",
                "element.top",
            ),
            Fault("never meets", BlockTiler, r"meets\.eq\(", "meets.eq(0 & "),
            Fault(
                "not as it is shifted",
                BlockTiler,
                r"~\(apart\[3\] & apart\[:3\]\.any\(\)\)",
                "~apart[3]",
                "_meets",
            ),
            Fault("empty, and no end in sight", BlockTiler, r"there & may\)", "there)"),
        ),
    )
]
