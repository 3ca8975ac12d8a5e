"""The stream guard: makes one frame of each packet."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from .axi_stream import PacketLayout

__all__ = ["StreamGuard"]


class StreamGuard(wiring.Component):
    """Makes one frame of each packet.

    A frame has an end (the end word, or the end beat), and a packet has TLAST. They should come
    together. If TLAST comes first, an end is inserted after it. If the end comes first, the words
    after it are dropped up to TLAST. A word with a byte missing is dropped, but its TLAST counts.
    Every packet therefore becomes exactly one frame.

    **Latency**: 0; 1 more for the first word of a packet. **Throughput**: a word a cycle, less one
    cycle to open a packet and one to insert an end.

    Parameters
    ----------
    shape
        Shape of a word.
    end
        The word that is inserted as an end.
    ends
        Function of a word: whether it ends a frame.

    Members
    -------
    i : In(stream of PacketLayout)
        The packets.
    o : Out(stream of shape)
        The frames.
    admit : In(1)
        A packet may open.
    cut : In(1)
        End the frame once the offered word has been taken, and drop the rest of its packet. If no
        frame is open, send an end alone.
    forget : In(1)
        Stop dropping: the next word opens a packet.
    open : Out(1)
        A frame has begun, and its end has not been taken.
    dropping : Out(1)
        The rest of a packet is being dropped.
    early, late, partial : Out(1)
        High for one cycle: TLAST came before the end; the end came without TLAST; a word with a
        byte missing was dropped.
    """

    def __init__(self, shape, end, ends):
        self.shape, self.end, self.ends = shape, end, ends
        super().__init__(
            {
                "i": In(stream.Signature(PacketLayout(shape))),
                "o": Out(stream.Signature(shape)),
                **dict.fromkeys(("admit", "cut", "forget"), In(1)),
                **dict.fromkeys(("open", "dropping", "early", "late", "partial"), Out(1)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        word = self.i.payload
        is_open = Signal()
        insert = Signal()  # the end is offered
        drop = Signal()
        cutting = Signal()  # a cut waits until the offered word has been taken
        passing = Signal()
        taken = Signal()
        dropped = Signal()
        ended = Signal()
        cut = Signal()
        m.d.comb += [
            cut.eq(self.cut | cutting),
            passing.eq(self.i.valid & is_open & ~insert),
            ended.eq(word.whole & self.ends(word.data)),
            self.o.valid.eq(insert | (passing & word.whole)),
            # Not in the m.If below, whose conditions depend on `o.ready`.
            self.o.payload.eq(Mux(insert, self.end, word.data)),
            self.i.ready.eq((drop & ~insert) | (passing & (self.o.ready | ~word.whole))),
            taken.eq(passing & self.i.ready),
            dropped.eq(self.i.valid & drop & ~insert),
            self.early.eq(taken & word.last & ~ended),
            self.late.eq(taken & ended & ~word.last),
            self.partial.eq(taken & ~word.whole),
            self.open.eq(is_open | insert),
            self.dropping.eq(drop),
        ]
        m.d.sync += cutting.eq(cut & ~insert)
        with m.If(insert):
            with m.If(self.o.ready):
                m.d.sync += [insert.eq(0), is_open.eq(0)]
        with m.Elif(taken):
            m.d.sync += [
                is_open.eq(~ended),
                insert.eq((word.last | cut) & ~ended),
                drop.eq((ended | cut) & ~word.last),
                cutting.eq(0),
            ]
        with m.Elif(cut & ~passing):
            m.d.sync += [insert.eq(1), drop.eq(drop | is_open), cutting.eq(0)]
        with m.Elif(~is_open & ~drop):
            m.d.sync += is_open.eq(self.i.valid & self.admit)
        with m.If((dropped & word.last) | self.forget):
            m.d.sync += drop.eq(0)
        return m
