"""A row of lanes with planes: each lane sums, saturates and compares a depth of its own."""

from amaranth.hdl import Cat, Mux, Signal, signed
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
    new : In(pixels_per_word x PixelLayout)
        The colour to draw in each column, or the pixel to load, in the cycle after the request. The
        depth is 0 if the request is not a load.
    columns : In(ColumnsLayout)
        What each column adds to the ``line`` of the request, in its cycle.
    """

    def _shares(self):
        """Return the members that depths come from, beside ``new``."""
        return {"columns": In(ColumnsLayout(self.config))}

    def _depths(self, m):
        """Return the depth to draw in each column, in the cycle after the request."""
        saturated = []
        for column in range(self.config.pixels_per_word):
            total = Signal(signed(sum_bits(self.config)), name=f"sum_{column}")
            m.d.comb += total.eq(self.request.line + self.columns[column])
            saturated.append(self._saturate(m, column, total))
        return saturated

    def _saturate(self, m, column, total):
        """Return a column's depth in the cycle after its sum.

        A pixel at the background's depth or beyond has that one: it is nearer than nothing. The sum
        of a load counts as before depth 0, and its depth of ``new`` is joined by gates.
        """
        bits = self.config.depth_bits
        level = Signal(bits, name=f"level_{column}", reset_less=True)
        before = Signal(name=f"before_{column}", reset_less=True)  # before depth 0
        beyond = Signal(name=f"beyond_{column}", reset_less=True)  # means nothing before depth 0
        saturated = Signal(bits, name=f"saturated_{column}")
        levels = total[SUM_FRACTION:]
        m.d.sync += [
            level.eq(levels[:bits]),
            before.eq(Mux(self.request.store, 1, levels[-1])),
            beyond.eq(levels[bits:-1].any()),
        ]
        drawn = Mux(before, 0, Mux(beyond, self.config.background_depth, level))
        m.d.comb += saturated.eq(drawn | self.new[column].depth)
        return saturated

    def _read(self, m, name, pixel):
        """Return the depth that was read; ``_test`` registers the one of its two words."""
        return pixel.depth

    def _test(self, m, column, stages, hazards, olds, writes, written):
        """Compare depths, and write the pixel of a column; a clear writes it in both words.

        The bit above the depths makes a clear or a load pass, whatever was read.
        """
        config, caught, depth = self.config, stages.caught, stages.depth[column]
        hidden, forwards, reads_odd = hazards
        old, earlier, forwarded = (
            Signal(config.depth_bits, name=f"{name}_{column}", reset_less=True)
            for name in ("old", "earlier", "forwarded")
        )
        stores = Signal(name=f"stores_{column}", reset_less=True)
        difference = Signal(config.depth_bits + 2, name=f"difference_{column}")
        passes = Signal(name=f"passes_{column}")
        draws, odd = stages.draws[column], stages.odd[column]
        read = Mux(reads_odd[column], olds["odd"], olds["even"])
        other = Mux(forwards[column], forwarded, old)
        m.d.sync += [
            old.eq(read),
            earlier.eq(depth),
            forwarded.eq(earlier),
            stores.eq(caught.store),
            draws.eq(Mux(caught.clear, 1, stages.mask[column])),
        ]
        m.d.comb += [
            difference.eq(Cat(depth, 0) - Cat(other, stores)),
            passes.eq(difference[-1] & draws),
            written.even[column].eq(passes & ~stages.not_even[column] & ~hidden.even[column]),
            written.odd[column].eq(passes & odd & ~hidden.odd[column]),
            writes["even"].en.eq(written.even[column]),
            writes["odd"].en.eq(written.odd[column]),
        ]

    def _meet(self, m, stages, written):
        """Find read-after-write hazards of the pixels in the test stage.

        ``hidden``: a nearer pixel was written one cycle before. ``forwards``: a pixel was written
        two cycles before. ``reads_odd``: the pixel in the catch stage was read from the odd word.
        Four-state simulators subtract what is read, so a clear reads a defined word and none is
        forwarded to it.
        """
        caught, words = stages.caught, written.shape()
        hidden, again = (Signal(words, name=name, reset_less=True) for name in ("hidden", "again"))
        count = self.config.pixels_per_word
        forwards = Signal(count, reset_less=True)
        reads_odd = Signal(count, reset_less=True)
        behind = Signal(count)
        m.d.comb += behind.eq(
            Cat(new >= last for new, last in zip(stages.new, stages.depth, strict=True))
        )
        m.d.sync += [
            reads_odd.eq(Mux(self.request.clear, -1, self.request.odd)),
            forwards.eq(
                Cat(
                    ~caught.store & Mux(reads_odd[n], again.odd[n], again.even[n])
                    for n in range(count)
                )
            ),
        ]
        for half in HALVES:
            now, then, last = self._groups(half, stages)
            hides = getattr(caught.again[0], half) & (then == last)
            meets = getattr(self.request.again[1], half) & (now == last)
            there = getattr(written, half)
            m.d.sync += [
                getattr(hidden, half).eq(Mux(hides & ~caught.store, there & behind, 0)),
                getattr(again, half).eq(Mux(meets, there, 0)),
            ]
        return hidden, forwards, reads_odd
