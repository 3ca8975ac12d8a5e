"""The sequencer: turns code words into elements with their line."""

from amaranth.hdl import Cat, Module, Mux, Signal, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from splatline.contract.config import EngineConfig
from splatline.rtl.layouts import CodeWordLayout, ElementLayout

__all__ = ["Sequencer"]


class Sequencer(wiring.Component):
    """Follows the control words and gives each element the engine's current line.

    Control words that advance the line are consumed here. The end word becomes an ``end`` token. A
    frame opens with its first code word, and only while ``admit`` is high.

    The sequencer stores no element: a code word waits on ``i`` until ``o`` takes it.

    **Latency**: 0. **Throughput**: one code word a cycle.

    Members
    -------
    i : In(stream of CodeWordLayout)
        The code words.
    o : Out(stream of ElementLayout)
        Elements, and one ``end`` token a frame. The line saturates far below every image.
    admit : In(1)
        A new frame may open.
    open : Out(1)
        Between the first code word of a frame and its end word.
    """

    def __init__(self, config: EngineConfig):
        self.config = config
        super().__init__(
            {
                "i": In(stream.Signature(CodeWordLayout(config))),
                "o": Out(stream.Signature(ElementLayout(config))),
                "admit": In(1),
                "open": Out(1),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        config = self.config
        codeword = self.i.payload

        rows_empty = Signal(4)
        control = Signal()
        end = Signal()
        top = Signal(ElementLayout(config)["top"].shape, init=-4)
        # Wide enough for any sum, whatever the widths of X and of the line.
        advanced = Signal(signed(max(len(top), config.x_bits + 1) + 1))
        lowest = (1 << len(top) - 1) - 1
        m.d.comb += [
            rows_empty.eq(Cat(row.first > row.last for row in codeword.scans)),
            control.eq(codeword.mode & rows_empty.all()),
            end.eq(codeword.diffuse[config.control_end.lsb - config.diffuse.lsb]),
            advanced.eq(top + codeword.x),
        ]

        element = self.o.payload
        may = Signal()  # a frame is open, or may open
        m.d.comb += [
            may.eq(self.open | self.admit),
            self.o.valid.eq(self.i.valid & may & (~control | end)),
            self.i.ready.eq(may & (self.o.ready | (control & ~end))),
            element.end.eq(control),
            element.top.eq(Mux(control, lowest, top)),
        ]
        for name in element.shape().members:
            if name == "line_modulo_4":  # early, as a multiplier follows
                m.d.comb += element.line_modulo_4.eq(top[:2])
            elif name not in ("top", "end"):
                m.d.comb += element[name].eq(codeword[name])
        with m.If(self.i.valid & self.i.ready):
            m.d.sync += self.open.eq(~(control & end))
            with m.If(control):
                overflow = ~advanced[-1] & advanced[len(top) - 1 : -1].any()
                m.d.sync += top.eq(Mux(end, -4, Mux(overflow, lowest, advanced)))
        return m
