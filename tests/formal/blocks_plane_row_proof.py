"""A row of lanes with planes keeps the nearest pixels, each of which has a depth of its own."""

from amaranth.hdl import Mux, Signal, signed

from splatline.contract.plane import SUM_FRACTION
from splatline.rtl.blocks.lane_row import LaneRow
from splatline.rtl.blocks.plane_row import PlaneLaneRow
from splatline.rtl.layouts import PixelLayout, sum_bits
from tests.formal.blocks_lane_row_proof import LaneRowProperties
from tests.formal.properties import SWIFT_NINE
from tests.formal.prove import Fault, Proof

__all__ = ["PROOFS"]

FEW_LEVELS = SWIFT_NINE.replace(name="few-levels", plane=True, depth_bits=3, slope_bits=3)
"""Few levels and slopes, of which every sum can still fall below 0 and rise above the largest."""


class PlaneRowProperties(LaneRowProperties):
    """The same, where a pixel's depth is the sum of its line's share and of its column's."""

    row = PlaneLaneRow

    def _new(self, m, caught):
        """Return the pixel by the contract: its depth in the cycle after its two shares.

        That of a load is given.
        """
        config, dut = self.config, self.dut
        total = Signal(signed(sum_bits(config)))
        pixel = Signal(PixelLayout(config), name="new_0")
        level, depth = total >> SUM_FRACTION, Signal(config.depth_bits)
        furthest = config.background_depth
        new = dut.new[self.column]
        m.d.comb += total.eq(dut.request.line + dut.columns[self.column])
        m.d.sync += depth.eq(Mux(level < 0, 0, Mux(level > furthest, furthest, level)))
        m.d.comb += [
            pixel.colour.eq(new.colour),
            pixel.depth.eq(Mux(caught.store & ~caught.clear, new.depth, depth)),
        ]
        self.given(m, "given_depth", (caught.store & ~caught.clear) | (new.depth == 0))
        return pixel


PROOFS = [
    Proof(
        name="lane row: planes",
        shows="a pixel is what was drawn nearest, each at the depth of its own place",
        build=lambda: PlaneRowProperties(FEW_LEVELS),
        depth=12,
        engine="abc bmc3",
        faults=(
            Fault("no depth test", PlaneLaneRow, r"difference\[-1\] & ", "", "_test"),
            Fault("ties drawn", PlaneLaneRow, r"Cat\(depth, 0\)", r"\g<0> - 1", "_test"),
            Fault("not cleared", PlaneLaneRow, r"Mux\(caught\.clear, 1, (.*)\)\)", r"\1)", "_test"),
            Fault(
                "cleared where it is nearer",
                PlaneLaneRow,
                r"stores\.eq\(caught\.store\)",
                "stores.eq(0)",
                "_test",
            ),
            Fault(
                "cleared to a depth",
                LaneRow,
                r"Mux\(caught\.clear, background, (new\[column\])\)",
                r"\1",
                "_stages",
            ),
            Fault(
                "nothing before 0",
                PlaneLaneRow,
                r"(self\.request\.store), 1, levels\[-1\]",
                r"\1, 1, 0",
                "_saturate",
            ),
            Fault(
                "loaded as the sum is",
                PlaneLaneRow,
                r"Mux\(self\.request\.store, 1, (.*)\)\)",
                r"\1)",
                "_saturate",
            ),
            Fault(
                "nothing beyond",
                PlaneLaneRow,
                r"levels\[bits:-1\]\.any\(\)",
                "0",
                "_saturate",
            ),
            Fault("the other word", PlaneLaneRow, r'olds\["odd"\]', 'olds["even"]', "_test"),
            Fault("as it was read", PlaneLaneRow, r"forwarded, old", "old, old", "_test"),
            Fault("the depth before", PlaneLaneRow, r"forwarded, old", "earlier, old", "_test"),
            Fault("as of another line", PlaneLaneRow, r" & \(now == last\)", "", "_meet"),
            Fault("over what is nearer", PlaneLaneRow, r"there & behind", "0", "_meet"),
            Fault("hidden by what is behind", PlaneLaneRow, r"there & behind", "there", "_meet"),
            Fault("an equal one drawn over", PlaneLaneRow, r"new >= last", "new > last", "_meet"),
            Fault("hidden by another line", PlaneLaneRow, r" & \(then == last\)", "", "_meet"),
            Fault(
                "not cleared where it was drawn", PlaneLaneRow, r" & ~caught\.store", "", "_meet"
            ),
            Fault(
                "leaves where nothing is cleared",
                LaneRow,
                r"Mux\(keep, self\.config\.background_depth, (pixel\.depth)\)",
                r"\1",
                "_leave",
            ),
        ),
    )
]
