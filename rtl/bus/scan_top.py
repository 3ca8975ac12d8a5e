"""The AXI top behind a scan chain, which needs five pins."""

from __future__ import annotations

from amaranth.hdl import Cat, ClockDomain, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from .axi_top import AxiTop

__all__ = ["ScanTop"]


class ScanTop(wiring.Component):
    """The AXI top behind a scan chain, to measure its clock rate.

    The AXI top has more ports than packages have pins. Here a flip-flop stands at each port, as the
    logic of a system on chip would. Each input is a flip-flop of a shift register from ``scan_in``.
    Each output is captured in a flip-flop of a shift register to ``scan_out``. It draws nothing.

    Parameters
    ----------
    top
        The AXI top.

    Members
    -------
    clk, rst : In(1)
        Clock, and synchronous reset.
    scan_in : In(1)
        Enters the shift register of the inputs in every cycle.
    capture : In(1)
        Captures all outputs; otherwise they move on by one.
    scan_out : Out(1)
        Leaves the shift register of the outputs.
    """

    def __init__(self, top: AxiTop):
        self.top = top
        self.config = top.config
        self.latency = top.latency
        self.clear_cycles = top.clear_cycles
        pins = dict.fromkeys(("clk", "rst", "scan_in", "capture"), In(1))
        super().__init__({**pins, "scan_out": Out(1)})

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        m.submodules.top = top = self.top
        m.domains.scan = scan = ClockDomain(reset_less=True)
        m.d.comb += [scan.clk.eq(self.clk), top.aclk.eq(self.clk), top.aresetn.eq(~self.rst)]
        ports = {name: member.flow for name, member in top.signature.members.items()}
        for name in ("aclk", "aresetn"):
            del ports[name]
        inputs = Cat(getattr(top, name) for name, flow in ports.items() if flow is In)
        outputs = Cat(getattr(top, name) for name, flow in ports.items() if flow is Out)
        entered = Signal(len(inputs), reset_less=True)
        left = Signal(len(outputs), reset_less=True)
        capture = Signal()
        m.d.comb += [inputs.eq(entered), self.scan_out.eq(left[0])]
        m.d.scan += [
            entered.eq(Cat(self.scan_in, entered)),
            capture.eq(self.capture),
            left.eq(Mux(capture, outputs, left[1:])),
        ]
        return m
