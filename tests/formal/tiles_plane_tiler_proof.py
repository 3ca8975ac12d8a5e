"""The tiler and the stage behind it against the contract: every pixel has its own depth."""

from amaranth.hdl import Module, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from splatline.contract.plane import SUM_FRACTION
from splatline.rtl.layouts import GeometryLayout
from splatline.rtl.tiles.layouts import TileLayout
from splatline.rtl.tiles.plane_depths import PlaneDepths
from splatline.rtl.tiles.tiler import Tiler
from tests.formal.plane_words import give_plane, plane_covers, plane_sum, saturated
from tests.formal.prove import Fault, Proof
from tests.formal.tiles_tiler_proof import TilerProperties
from tests.formal.window_properties import Narrow

__all__ = ["PROOFS"]

SMALL = Narrow(plane=True, x_bits=4, line_bits=5, depth_bits=3, slope_bits=1)
"""Four words of four pixels a line, an image of up to 32 lines, and eight levels.

Sums of the one plane still fall below 0 and rise beyond the background's depth.
"""


class PlaneTiler(wiring.Component):
    """A tiler and the stage behind it, with the ports of a tiler."""

    def __init__(self, config):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(GeometryLayout(config))),
                "o": Out(stream.Signature(TileLayout(config))),
                "oldest": In(signed(config.line_bits + 2)),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
            }
        )

    def elaborate(self, platform):
        """Connect the two as the engine does."""
        m = Module()
        m.submodules.tiler = tiler = Tiler(self.config)
        m.submodules.depths = depths = PlaneDepths(self.config)
        connect(m, flipped(self.i), tiler.i)
        connect(m, tiler.o, depths.i)
        connect(m, depths.o, flipped(self.o))
        m.d.comb += [
            tiler.ending.eq(depths.ending),
            tiler.oldest.eq(self.oldest),
            tiler.last_column.eq(self.last_column),
            tiler.last_line.eq(self.last_line),
        ]
        return m


class PlaneTilerProperties(TilerProperties):
    """The pixels of plane words that are not beyond the background, each at its own depth."""

    tiler = PlaneTiler
    inside = 3

    def _covers(self, m, element, row, column):
        """Return whether an element has the pixel, and it is not beyond the background's depth."""
        self.total = plane_sum(m, self.config, element, row, column)
        before = self.total >> SUM_FRACTION <= self.config.background_depth
        return plane_covers(element, row, column) & before

    def _depth(self, m, element, row, column):
        """Return the depth of an element's pixel, by the contract."""
        depth = Signal(self.config.depth_bits)
        m.d.comb += depth.eq(saturated(self.config, self.total))
        return depth

    def _drawn_depth(self, m, tile, slot, column):
        """Return the depth of a tile's pixel."""
        return tile.depth[slot[:2]][column[: self.config.pixel_bits]]

    def _assume(self, m, taken, given):
        """Assume of elements, their planes and the window what they are."""
        give_plane(m, self.config, self.dut.i.payload)
        return super()._assume(m, taken, given)


PROOFS = [
    Proof(
        name="tiler: planes",
        shows="an element's tiles have the contract's pixels, each once, at the depth of its place",
        build=lambda: PlaneTilerProperties(SMALL),
        depth=8,
        engine="abc bmc3",
        slow=True,
        long=True,
        faults=(
            Fault("no slope of the lower half", Tiler, r"lower \+ past", "past", "_plane"),
            Fault("the wrong group of lines", Tiler, r"past\[i\]", "past[0]", "_plane"),
            Fault("the wrong tile of two", Tiler, r"column \+ tile\.next", "tile.next", "_plane"),
            Fault("columns of the word before", Tiler, r"tile\.next\[j\]", "0", "_plane"),
            Fault("the block's own column", Tiler, r" - given\.before", "", "_plane"),
            Fault("the block's own line", Tiler, r" - given\.above", "", "_plane"),
            Fault("moved beyond the block", Tiler, r"moved & ~stays", "moved", "_halves"),
            Fault("moved the other way", Tiler, r"Mux\(out, -1, 1\)", "Mux(out, 1, -1)", "_halves"),
            Fault("an empty row's half turn", Tiler, r" & shape\.filled\[k\]", "", "_halves"),
            Fault("nothing before depth 0", PlaneDepths, r"step & total\[-1\]", "0", "_sum"),
            Fault("nothing beyond", PlaneDepths, r" & ~beyond", "", "_sum"),
            Fault("beyond before depth 0", PlaneDepths, r" & ~total\[-1\]", "", "_sum"),
            Fault("no overlap", PlaneDepths, r"overlap\(m, tile, given\)", "0"),
            Fault("the top of the tile after", PlaneDepths, r"payload\.top\.eq\(top\)",
                  "payload.top.eq(tile.top)"),
        ),
    )
]  # fmt: skip
