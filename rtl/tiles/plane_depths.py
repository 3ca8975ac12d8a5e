"""The stage of the tiles engine that gives each pixel of a tile its own depth."""

from amaranth.hdl import Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.contract.plane import SUM_FRACTION
from splatline.rtl.layouts import sum_bits

from .layouts import PlaneTileLayout, TileLayout
from .overlap import overlap

__all__ = ["PlaneDepths"]


class PlaneDepths(wiring.Component):
    """Sums the planes of tiles at each pixel, saturating.

    A depth below 0 becomes 0. A pixel beyond the background's depth leaves the mask, as it is
    nearer than nothing.

    The sums wrap in ``sum_bits`` bits, which hold the depth of every pixel of a block.

    **Latency**: 1 cycle. **Throughput**: one tile a cycle.

    Members
    -------
    i : In(stream of PlaneTileLayout)
        Tiles with planes, and ``end`` tokens.
    o : Out(stream of TileLayout)
        The same with depths. ``top`` is that of ``i`` when it was last taken, or could have been.
    shade : In(colour_bits)
        Colour of the tile that is offered on ``i``.
    shaded : Out(colour_bits)
        Colour of the tile that is offered on ``o``.
    ending : Out(1)
        An ``end`` token is offered on ``o``.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(PlaneTileLayout(config))),
                "o": Out(stream.Signature(TileLayout(config))),
                "shade": In(config.colour_bits),
                "shaded": Out(config.colour_bits),
                "ending": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        tile = self.i.payload
        valid = Signal()
        step = Signal()
        given = Signal(TileLayout(self.config), reset_less=True)
        top = Signal(tile.top.shape(), name="given_top", init=-len(tile.group))
        shaded = Signal(self.config.colour_bits, reset_less=True)
        m.d.comb += [
            step.eq(~valid | self.o.ready),
            self.i.ready.eq(step),
            self.o.valid.eq(valid),
            self.o.payload.eq(given),
            self.o.payload.top.eq(top),
            self.shaded.eq(shaded),
            self.ending.eq(valid & given.end),
        ]
        same = [
            name
            for name in self.i.payload.shape().members
            if name in given.shape().members and name not in ("mask", "top")
        ]
        with m.If(step):
            m.d.sync += [valid.eq(self.i.valid), top.eq(tile.top), shaded.eq(self.shade)]
            m.d.sync += [given[name].eq(tile[name]) for name in same]
            m.d.sync += given.meets.eq(overlap(m, tile, given) & valid & self.o.ready)
        for i in range(len(tile.group)):
            line = Signal(sum_bits(self.config), name=f"line_{i}")
            m.d.comb += line.eq(tile.corner + tile.down[i])
            for j in range(self.config.pixels_per_word):
                self._sum(m, i, j, line, given, step)
        return m

    def _sum(self, m, i, j, line, given, step):
        """Set a pixel's depth and its bit of the mask."""
        tile, bits = self.i.payload, self.config.depth_bits
        total = Signal(sum_bits(self.config), name=f"sum_{i}_{j}")
        before = Signal(name=f"before_{i}_{j}")
        level = total[SUM_FRACTION:]
        m.d.comb += [
            total.eq(line + tile.across[j]),
            before.eq(step & total[-1]),
        ]
        with m.If(before):
            m.d.sync += given.depth[i][j].eq(0)
        with m.Elif(step):
            m.d.sync += given.depth[i][j].eq(level[:bits])
        with m.If(step):
            beyond = level[bits:-1].any() & ~total[-1]
            m.d.sync += given.mask[i][j].eq(tile.mask[i][j] & ~beyond)
