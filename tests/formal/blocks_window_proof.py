"""The window of blocks: its lines never mix, and no pixel is lost or invented."""

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import BLOCK, ROWS
from splatline.rtl.blocks import window
from splatline.rtl.blocks.dirty_bits import residue_bits
from splatline.rtl.blocks.flush_scan import BlockFlushScan
from splatline.rtl.blocks.lane_row import LaneRow, row_address_bits
from splatline.rtl.blocks.plane_row import PlaneLaneRow
from splatline.rtl.blocks.readout import BlockReadout
from splatline.rtl.blocks.window import BlockWindow
from splatline.rtl.layouts import RasterLayout, sum_bits
from splatline.rtl.window.frame_overlap import FrameOverlap
from splatline.rtl.window.loader import Loader
from tests.formal.plane_words import saturated
from tests.formal.properties import OneWord, any_value
from tests.formal.prove import Fault, Proof
from tests.formal.window_properties import Narrow, TileWindowProperties

__all__ = ["PROOFS", "Passing", "any_value", "comes_to_top", "lines_are_there"]

TINY = Narrow(
    window="blocks",
    raster_words=2,
    pixels_per_word=2,
    x_bits=3,
    line_bits=5,
    depth_bits=2,
    channel_bits=1,
)
"""Two beats of two words of two pixels a line, sixteen lines in the window, an image of up to 32.

So the blocks are two columns wide. A column knows nothing of the others.
"""


TINY_PLANE = TINY.replace(plane=True, slope_bits=1)
"""The same with planes of few levels: a pixel's depth is the sum of any line's and column's."""


class Passing(wiring.Component):
    """In place of the fifo: a register, as all that it offers is taken."""

    def __init__(self, config):
        beats = stream.Signature(RasterLayout(config))
        super().__init__({"i": In(beats), "o": Out(beats)})

    def elaborate(self, platform):
        """Build it."""
        m = Module()
        m.d.sync += [self.o.valid.eq(self.i.valid), self.o.payload.eq(self.i.payload)]
        return m


def lines_are_there(m, config, window, block, top):
    """Return whether a block may come, by what the window said a cycle before, and ``top`` was."""
    said = data.StructLayout(
        {"oldest": window.oldest.shape(), "cleared": window.cleared.shape(), "empties": 1}
    )
    # None is in the window before it said anything.
    then = Signal(said, name="said_then", init={"oldest": -2 * config.window_lines})
    m.d.sync += [getattr(then, name).eq(getattr(window, name)) for name in said.members]

    def is_free(place):
        below = (place - block.top)[: config.slot_bits]
        return below >= Mux(block.mode, ROWS, BLOCK)

    inside = block.top - then.oldest < config.window_lines - BLOCK
    comes = then.empties & (top == block.top) & is_free(then.oldest)
    return (inside | comes) & (~then.cleared.valid | is_free(then.cleared.place))


def comes_to_top(m, window, offered, top):
    """Return whether the window is where it said a cycle before that it was about to come to.

    That is ``top`` as it was then, if nothing was ``offered``.
    """
    told, oldest = Signal(), Signal.like(window.oldest, name="oldest_before_it_comes")
    m.d.sync += [told.eq(window.empties & ~offered), oldest.eq(window.oldest)]
    return ~told | (window.oldest == Mux(top > oldest, top, oldest))


class BlockWindowProperties(TileWindowProperties):
    """Any one pixel of any one place in the window, followed from line to line.

    As of tiles, but of blocks only what :class:`BlockLayout` says is assumed, which
    ``blocks_tiler_proof`` proves. The fifo of the readout has room when it likes; that it holds
    what it then must is in ``blocks_readout_proof`` and ``fifo_proof``.
    """

    delay = 5  # two stages more than with tiles: requests and what leaves stand in registers
    window = BlockWindow
    flush_scan = BlockFlushScan

    def describe(self, m):
        """Add the window and its properties."""
        super().describe(m)
        self.given(m, "taken", self.dut.raster.ready)

    def _memories(self, m):
        """Return what the lanes' memories are: the pixel's word, which is background."""
        address = Signal(row_address_bits(self.config))
        m.d.comb += address.eq(Cat(self.word[1:], self.slot[residue_bits(self.config) :]))
        return OneWord(address, init=self.config.background_depth)

    def _mark(self, m, flush_scan):
        """Assert what the flush scan takes for granted while it may take dirty bits.

        Nothing is loaded, or drawn into lines of that residue.
        """
        residue = flush_scan.line[: residue_bits(self.config)]
        touched = Cat(touch.any() for touch in flush_scan.touch).bit_select(residue, 1)
        busy = (flush_scan.drawing & touched) | flush_scan.load.any()
        self.always(m, "markable", ~(flush_scan.enable.bit_select(residue, 1) & busy))

    def _tiles(self, m):
        """Assume of the blocks what they are; return whether one draws the pixel now.

        One without pixels as well waits for its lines, and an end token is offered at once: else
        ``top`` would be far below the window, and so would the lines that have left, as it comes.
        """
        config, dut = self.config, self.dut
        block = dut.i.payload
        top, passed = (Signal.like(block.top, name=name, init=-ROWS) for name in ("now", "passed"))
        waited = Signal(name="block_waited")
        m.d.sync += [top.eq(block.top), waited.eq(dut.i.valid & ~dut.i.ready)]
        with m.If(dut.i.valid & dut.i.ready):
            m.d.sync += passed.eq(block.top)
        with m.If(self.close):
            m.d.sync += [top.eq(-ROWS), passed.eq(-ROWS)]
        there = lines_are_there(m, config, dut, block, top)
        self.given(m, "there", ~dut.i.valid | waited | block.end | there)
        for row in range(BLOCK):
            touch, mask, odd = block.touch[row], block.mask[row], block.odd[row]
            touches = touch == Cat((mask & odd).any(), (mask & ~odd).any())
            self.given(m, f"touch_{row}", ~dut.i.valid | touches)
            self.given(m, f"rows_{row}", ~dut.i.valid | (block.rows[row] == mask.any()))
            lower = (row - block.top[:3])[2]
            self.given(m, f"mode_{row}", ~(dut.i.valid & block.mode & lower) | ~mask.any())
        self.always(m, "comes", comes_to_top(m, dut, dut.i.valid, top))
        self.given(m, "end_at_once", ~(dut.i.valid & block.end & ~waited) | (top == passed))
        return super()._tiles(m)

    def _settled(self, line, oldest):
        """Return nothing more than what is assumed of the whole block."""
        return 1

    def _meet(self, m, tile, both):
        """Blocks may follow each other into any pixel."""

    def _drawn_depth(self, block):
        """Return the depth of the pixel in a block; with planes the sum of its shares."""
        if not self.config.plane:
            return block.z
        total = block.lines[self.slot[: residue_bits(self.config)]] + block.columns[self.number]
        return saturated(self.config, total[: sum_bits(self.config)].as_signed())

    def _second(self, tile, row, column):
        """Return whether a pixel of a block lies in the second of its words."""
        return tile.odd[row].bit_select(column, 1) ^ tile.words[0][0]


OURS = '__import__("importlib").import_module("tests.formal.blocks_window_proof")'
CHANGES = (
    Fault("no fifo", BlockReadout, r"Fifo\(config, DEPTH\)", f"{OURS}.Passing(config)"),
    Fault(
        "room", BlockReadout, r"queue\.level < DEPTH // 2", f'{OURS}.any_value(m, 1, "any_room")'
    ),
    Fault(
        "the sweep's last cycle", BlockWindow, r"(sweep = Signal\(.*)\)", r"\1, init=-1)", "_clear"
    ),
    Fault(
        "nothing was requested before",
        BlockWindow,
        r", reset_less=True(\)\s+for q in range\(BLOCK\))",
        r"\1",
        "_rows",
    ),
    Fault(
        "nothing was caught before", LaneRow, r", reset_less=True(\)  # of what)", r"\1", "_stages"
    ),
    Fault(
        "nothing was drawn before",
        LaneRow,
        r"(draws = .*), init=-1, reset_less=True",
        r"\1",
        "_stages",
    ),
)
"""The fifo is as said above, and the lanes have been cleared but for their last pixels.

What a row writes in the three cycles after a reset, as these registers have none, comes before the
sweep's first pixel is written.
"""


def plan(name, shows, load, depth, *faults, config=TINY):
    """Return a proof of the window."""
    return Proof(
        name=name,
        shows=shows,
        build=lambda: BlockWindowProperties(config, load),
        depth=depth,
        engine="abc bmc3",
        changes=CHANGES,
        faults=faults,
        slow=True,
        long=True,
    )


PROOFS = [
    plan(
        "window of blocks",
        "a pixel leaves with its own line, as it was drawn, once; none is lost or invented",
        0,
        15,
        Fault("no depth test", LaneRow, r"difference\[-1\] & ", "", "_test"),
        Fault("as it was a cycle before", LaneRow, r"Mux\(hides & [^,]+,", "Mux(0,", "_meet"),
        Fault("as it was read", LaneRow, r"Mux\(meets,", "Mux(0,", "_meet"),
        Fault(
            "drawn over what is nearer",
            BlockWindow,
            r"block\.z >= other",
            "block.z < other",
            "_follow",
        ),
        Fault("not told what was drawn", BlockWindow, r"other\.drawn & same", "0", "_follow"),
        Fault(
            "a block goes where dirty bits do",
            BlockWindow,
            r"& ~\(marks_first & marking\)",
            "",
            "_arbitrate",
        ),
        Fault(
            "a row not kept for a block",
            BlockWindow,
            r"\(first \| ~\(offered & meeting\)\)",
            "1",
            "_arbitrate",
        ),
        Fault(
            "dirty bits taken where a block is drawn",
            BlockWindow,
            r"\(marks_first\.replicate\(BLOCK\) \| ~reserved\)",
            "0xFF",
            "_arbitrate",
        ),
        Fault("dirty bits taken over beats", BlockFlushScan, r" & ~behind\.any\(\)", "", "_beats"),
        Fault("not held by its beats", BlockFlushScan, r"m\.Elif\(turns\)", "m.Elif(1)", "_beats"),
        Fault(
            "jumps over what is written",
            BlockFlushScan,
            r"self\.jump & clean",
            "self.jump",
            "_look",
        ),
        Fault(
            "comes while beats are behind",
            BlockFlushScan,
            r"~behind\.any\(\) & leaving\.free",
            "leaving.free",
            "_beats",
        ),
        Fault(
            "comes while there is no room",
            BlockWindow,
            r"flush_scan\.empties & readout\.room",
            "flush_scan.empties",
            "_connect_frame",
        ),
        Fault("a turn ahead unnoticed", FrameOverlap, r"self\.wraps &", "0 &"),
        Fault("frames meet", FrameOverlap, r"turns\[1:\], self\.closing", "turns[1:], 0"),
        Fault("over too early", FrameOverlap, r"self\.clean \| self", "1 | self"),
        Fault(
            "a frame closed twice", BlockWindow, r" & ~flush_scan\.closing", "", "_connect_frame"
        ),
        Fault("closed twice at once", BlockWindow, r" & ~close\)", ")", "_connect_frame"),
        Fault("over before its beats", BlockReadout, r" & ~valid\.any\(\)", ""),
        Fault("not clipped", BlockWindow, r"is_last & ", "0 & ", "_outside"),
    ),
    plan(
        "window of blocks, further",
        "the same, until every fault that is known of shows",
        0,
        16,
        Fault(
            "a block goes where a beat does",
            BlockWindow,
            r"& ~\(first & meeting\)",
            "",
            "_arbitrate",
        ),
    ),
    plan(
        "window of blocks, initial raster",
        "the same for frames that start from an initial raster",
        1,
        14,
        Fault("loaded beyond the window", Loader, r"& ~drop & in_window", "& ~drop"),
        Fault(
            "a block drawn beside a load",
            BlockWindow,
            r"~serving & ~swept",
            "~swept",
            "_arbitrate",
        ),
        Fault("half a beat", BlockWindow, r"loading & odd", "loading", "_arbitrate"),
        Fault("the even word for both", window, r"is_odd\.eq\(odd\)", "is_odd.eq(0)",
              "register_columns"),
        Fault(
            "loaded while the last is swept",
            BlockWindow,
            r"eq\(serving & ~swept\)",
            "eq(serving)",
            "_arbitrate",
        ),
        Fault(
            "where the frame before was",
            BlockWindow,
            r"-2 \* config\.window_lines",
            "flush_scan.front",
            "_connect_frame",
        ),
        Fault(
            "a beat leaves for one that is loaded",
            BlockWindow,
            r"room & ~serving &",
            "room &",
            "_arbitrate",
        ),
        Fault("a line left unloaded", BlockFlushScan, r"self\.jump \| loaded", "1", "_look"),
        Fault(
            "limit a line too far", Loader, r"(limit\.eq\(Mux\(in_window, beat\.line)", r"\1 + 1"
        ),
    ),
    plan(
        "window of blocks, planes",
        "the same with a depth for each pixel",
        0,
        14,
        Fault("no depth test", PlaneLaneRow, r"difference\[-1\] & ", "", "_test"),
        Fault("another line's share", window, r"block\.lines\[q\]", "block.lines[0]",
              "request_pixels"),
        Fault("columns of the block after", BlockWindow, r"m\.d\.sync \+= (columns\.eq)",
              r"m.d.comb += \1", "_rows"),
        Fault("not told what was drawn", BlockWindow, r"other\.drawn & same", "0", "_follow"),
        config=TINY_PLANE,
    ),
]  # fmt: skip
