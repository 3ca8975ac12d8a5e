"""From one frame to the next: the lines of the one leave while the other is being drawn."""

from amaranth.hdl import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig

__all__ = ["FrameOverlap"]


class FrameOverlap(wiring.Component):
    """Says where the window lies for the frame that is being drawn, and when the other is over.

    Line n of every frame stands in place n mod ``window_lines``, so the next frame's line 0 follows
    the last line of the window's turn in which the frame ends. Once that frame is complete
    (``close``), the window lies before the next frame, by one turn: at ``oldest`` modulo the turn,
    less the turn; by two as long as lines of the frame that ends lie beyond the present turn
    (``wraps``). The frame is over at the end of its turn, or once nothing at all is written.

    **Latency**: 0 cycles to ``front``; 1 from the last line that leaves to ``over``.

    Members
    -------
    oldest : In(line_bits + 1)
        First line in the window, of the frame that leaves.
    line : In(line_bits + 1)
        The line that leaves next: ``oldest``, or what is read ahead of it.
    leaves : In(1)
        It leaves in this cycle; not while ``halted``.
    wraps : In(1)
        Something is written in this cycle into a place before that of ``line``: a turn ahead,
        unless ``line`` moves on by many lines.
    clean : In(1)
        Nothing in the window is written.
    close : In(1)
        The frame at hand is complete; not while ``closing``.
    restart : In(1)
        The frame that leaves is over, which ``over`` said: both are the same again.
    closing : Out(1)
        The frame that leaves is not the one that is drawn.
    last : Out(1)
        ``line`` is the last that can be left of a frame that was closed: no other follows.
    halted : Out(1)
        It has left.
    front : Out(signed(line_bits + 2))
        First line in the window, of the frame that is drawn.
    over : Out(1)
        Nothing of the frame that leaves is in the window any more.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "oldest": In(config.line_bits + 1),
                "line": In(config.line_bits + 1),
                **dict.fromkeys(("leaves", "wraps", "clean", "close", "restart"), In(1)),
                **dict.fromkeys(("closing", "last", "halted", "over"), Out(1)),
                "front": Out(signed(config.line_bits + 2)),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        bits = self.config.slot_bits
        wrapped = Signal()  # lines may be written beyond the turn that ``line`` is in
        turn_ends = Signal()
        turns = self.oldest[bits:] | self.closing.replicate(len(self.oldest) - bits)
        # Where ``line`` is not ``oldest`` itself, it lies in the same turn or the next.
        two = wrapped | (self.line[bits] ^ self.oldest[bits])
        turn = turns[0] & ~(self.closing & two)
        m.d.comb += [
            turn_ends.eq(self.line[:bits].all()),
            self.last.eq(turn_ends & self.closing & ~wrapped),
            self.over.eq((self.closing | self.close) & (self.clean | self.halted)),
            self.front.eq(Cat(self.oldest[:bits], turn, turns[1:], self.closing)),
        ]
        with m.If(self.leaves & turn_ends):
            m.d.sync += [wrapped.eq(0), self.halted.eq(self.last)]
        with m.Elif(self.wraps & ~self.closing):
            m.d.sync += wrapped.eq(1)
        with m.Elif(self.clean):
            m.d.sync += wrapped.eq(0)
        with m.If(self.close):
            m.d.sync += self.closing.eq(1)
        with m.If(self.restart):
            m.d.sync += [self.closing.eq(0), self.halted.eq(0), wrapped.eq(0)]
        return m
