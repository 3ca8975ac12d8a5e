"""A row of lanes with planes: each lane sums, saturates and compares a depth of its own."""

from amaranth.hdl import Cat, Mux, Signal, signed
from amaranth.lib import data
from amaranth.lib.wiring import In

from splatline.contract.plane import SUM_FRACTION
from splatline.rtl.layouts import sum_bits

from .lane_row import HALVES, LaneRow
from .layouts import ColumnsLayout

__all__ = ["PlaneLaneRow"]


class PlaneLaneRow(LaneRow):
    """As :class:`LaneRow`, with a depth for every pixel.

    *Read*: a lane adds the shares of its line and of its column. *Catch*: the sum saturates, and
    the word of the pixel that was read is chosen. *Test*: depths are compared.

    Read-after-write hazards: an element may be nearer than the one before in one lane, and further
    away in the next. So lanes compare depths, not the window. If the request of two cycles before
    has written the pixel, its depth takes the place of the one that was read: the LUTs of the
    comparison have two inputs to spare for the choice. If the request of the cycle before writes
    the pixel, the new one is compared with the older pixel and is written a cycle later. It is
    ``hidden`` unless it is nearer than that one's pixel, which a second comparison tells.

    **Latency**, **throughput**: as of :class:`LaneRow`.

    Members
    -------
    new : In(colour)
        Colour of the pixels to draw, in the cycle after the request.
    columns : In(ColumnsLayout)
        What each column adds to the ``line`` of the request, in its cycle.
    """

    def _new(self):
        """Return the members that give what is drawn."""
        return {
            "new": In(data.StructLayout({"colour": self.config.colour_bits})),
            "columns": In(ColumnsLayout(self.config)),
        }

    def _depths(self, m, caught):
        """Return the depth to draw in each column, and the one that is written a cycle later."""
        background = self.config.background_depth
        saturated, written = [], []
        for column in range(self.config.pixels_per_word):
            total = Signal(signed(sum_bits(self.config)), name=f"sum_{column}")
            depth = Signal(
                self.config.depth_bits, name=f"depth_{column}", init=background, reset_less=True
            )
            m.d.comb += total.eq(self.request.line + self.columns[column])
            saturated.append(self._saturate(m, column, total))
            m.d.sync += depth.eq(Mux(caught.clear, background, saturated[column]))
            written.append(depth)
        return saturated, written

    def _saturate(self, m, column, total):
        """Return a column's depth in the cycle after its sum.

        A pixel at the background's depth or beyond has that one: it is nearer than nothing.
        """
        bits = self.config.depth_bits
        level = Signal(bits, name=f"level_{column}", reset_less=True)
        before = Signal(name=f"before_{column}", reset_less=True)  # before depth 0
        beyond = Signal(name=f"beyond_{column}", reset_less=True)  # means nothing before depth 0
        saturated = Signal(bits, name=f"saturated_{column}")
        levels = total[SUM_FRACTION:]
        m.d.sync += [
            level.eq(levels[:bits]),
            before.eq(levels[-1]),
            beyond.eq(levels[bits:-1].any()),
        ]
        m.d.comb += saturated.eq(Mux(before, 0, Mux(beyond, self.config.background_depth, level)))
        return saturated

    def _read(self, m, name, pixel, caught):
        """Return the depth that was read; ``_test`` registers the one of its two words."""
        return pixel.depth

    def _test(self, m, column, stages, hazards, olds, writes, written):
        """Compare depths, and write the pixel of a column; a clear writes it in both words.

        The bit above the depths makes a clear pass, whatever was read.
        """
        config, caught, depth = self.config, stages.caught, stages.depth[column]
        hidden, forwards = hazards
        old, earlier, forwarded = (
            Signal(config.depth_bits, name=f"{name}_{column}", reset_less=True)
            for name in ("old", "earlier", "forwarded")
        )
        clears = Signal(name=f"clears_{column}", reset_less=True)
        difference = Signal(config.depth_bits + 2, name=f"difference_{column}")
        passes = Signal(name=f"passes_{column}")
        draws, odd = stages.draws[column], stages.odd[column]
        read = Mux(caught.odd[column], olds["odd"], olds["even"])
        other = Mux(forwards[column], forwarded, old)
        m.d.sync += [
            # A memory that was not cleared yet is undefined.
            old.eq(Mux(caught.clear, config.background_depth, read)),
            earlier.eq(depth),
            forwarded.eq(earlier),
            clears.eq(caught.clear),
            draws.eq(Mux(caught.clear, 1, stages.mask[column])),
        ]
        m.d.comb += [
            difference.eq(Cat(depth, 0) - Cat(other, clears)),
            passes.eq(difference[-1] & draws),
            written.even[column].eq(passes & ~stages.not_even[column] & ~hidden.even[column]),
            written.odd[column].eq(passes & odd & ~hidden.odd[column]),
            writes["even"].en.eq(written.even[column]),
            writes["odd"].en.eq(written.odd[column]),
        ]

    def _meet(self, m, stages, written):
        """Find read-after-write hazards of the pixels in the test stage.

        ``hidden``: a nearer pixel was written one cycle before. ``forwards``: a pixel was written
        two cycles before.
        """
        caught, words = stages.caught, written.shape()
        hidden, again = (Signal(words, name=name, reset_less=True) for name in ("hidden", "again"))
        count = self.config.pixels_per_word
        forwards = Signal(count, reset_less=True)
        behind = Signal(count)
        m.d.comb += behind.eq(
            Cat(new >= last for new, last in zip(stages.before, stages.depth, strict=True))
        )
        m.d.sync += forwards.eq(
            Cat(Mux(caught.odd[n], again.odd[n], again.even[n]) for n in range(count))
        )
        for half in HALVES:
            now, then, last = self._groups(half, stages)
            hides = getattr(caught.again[0], half) & (then == last)
            meets = getattr(self.request.again[1], half) & (now == last)
            there = getattr(written, half)
            m.d.sync += [
                getattr(hidden, half).eq(Mux(hides & ~caught.clear, there & behind, 0)),
                getattr(again, half).eq(Mux(meets & ~self.request.clear, there, 0)),
            ]
        return hidden, forwards
