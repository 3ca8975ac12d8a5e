"""Frame overlap: a frame is drawn while the lines of the one before leave."""

from amaranth.hdl import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig

__all__ = ["FrameOverlap"]


class FrameOverlap(wiring.Component):
    """Gives the window's first line for the frame that is drawn, and the end of the frame before.

    Line n of every frame is in slot n mod ``window_lines``. The next frame's line 0 therefore comes
    a lap after the lap in which the frame ends. Once a frame is complete (``close``), the window
    lies one lap before the next frame: ``front`` is ``oldest`` modulo a lap, less a lap. It is less
    two laps while the closed frame has dirty lines in the lap after the present one (``wraps``).
    The frame is over at the end of its last lap, or once the window is clean.

    **Latency**: 0 cycles to ``front``; 1 from the last line that leaves to ``over``.
    **Throughput**: a line a cycle.

    Members
    -------
    oldest : In(line_bits + 1)
        First line in the window, in lines of the frame that leaves.
    line : In(line_bits + 1)
        The line that leaves next: ``oldest``, or a line that is scanned ahead of it.
    leaves : In(1)
        ``line`` leaves in this cycle; never while ``halted``.
    wraps : In(1)
        A slot before that of ``line`` is written in this cycle. The write is in the next lap,
        unless ``line`` advances by many lines.
    clean : In(1)
        All lines of the window are clean.
    close : In(1)
        The frame that is drawn is complete; never while ``closing``.
    restart : In(1)
        The closed frame is over, as ``over`` showed: from now on one frame is drawn and leaves.
    closing : Out(1)
        The frame that leaves is not the one that is drawn.
    last : Out(1)
        ``line`` is the last line of a closed frame's last lap.
    halted : Out(1)
        This line has left.
    front : Out(signed(line_bits + 2))
        First line in the window, in lines of the frame that is drawn.
    over : Out(1)
        The closed frame has left the window.
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
        wrapped = Signal()  # lines after the lap of ``line`` may be dirty
        turn_ends = Signal()
        turns = self.oldest[bits:] | self.closing.replicate(len(self.oldest) - bits)
        # ``line`` is in the same lap as ``oldest``, or in the next.
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
