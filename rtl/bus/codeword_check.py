"""Checks code words for positions out of range."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import CodeWordLayout

__all__ = ["CodeWordCheck", "end_word", "is_control", "is_end"]


def is_control(codeword):
    """Return whether a code word is a control word (``docs/contract.md``)."""
    return codeword.mode & Cat(row.first > row.last for row in codeword.scans).all()


def is_end(codeword):
    """Return whether a code word ends the frame."""
    return is_control(codeword) & codeword.diffuse[0]


def end_word(config: EngineConfig):
    """Return the code word that ends a frame."""
    empty = [{"first": 7, "last": 0}] * 4
    return CodeWordLayout(config).const({"mode": 1, "scans": empty, "diffuse": 1})


class CodeWordCheck(wiring.Component):
    """Checks the code words that an engine takes, and never stalls them.

    The engine clips elements outside the image. The check reports that it had to.

    **Latency**: 1 cycle. **Throughput**: a word a cycle.

    Parameters
    ----------
    config
        The engine's configuration.

    Members
    -------
    codeword : In(CodeWordLayout)
        A code word.
    taken : In(1)
        The engine takes it in this cycle.
    last_column : In(x_bits), last_line : In(line_bits)
        Size of the image less 1.
    element : Out(1)
        The code word was an element.
    x_outside : Out(1)
        The code word was an element with X beyond the last column.
    line_past : Out(1)
        The code word was a step to a line y with y - 4 beyond the last line.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "codeword": In(CodeWordLayout(config)),
                "taken": In(1),
                "last_column": In(config.x_bits),
                "last_line": In(config.line_bits),
                "element": Out(1),
                "x_outside": Out(1),
                "line_past": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        # A register first, because ``taken`` comes late in the cycle.
        taken = Signal()
        control = Signal()
        end = Signal()
        x = Signal(config.x_bits, reset_less=True)
        m.d.sync += [
            taken.eq(self.taken),
            control.eq(is_control(self.codeword)),
            end.eq(self.codeword.diffuse[0]),
            x.eq(self.codeword.x),
        ]

        # Lines saturate far below every image, as the engine's do.
        line = Signal(max(config.line_bits, config.x_bits) + 1)
        lowest = (1 << len(line)) - 1
        reached = Signal(len(line) + 1)
        m.d.comb += [
            reached.eq(line + x),
            self.element.eq(taken & ~control),
            self.x_outside.eq(self.element & (x > self.last_column)),
            self.line_past.eq(taken & control & ~end & (reached > self.last_line + 4)),
        ]
        with m.If(taken & control):
            m.d.sync += line.eq(Mux(end, 0, Mux(reached[-1], lowest, reached)))
        return m
