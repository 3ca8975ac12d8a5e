"""AXI4-Stream ports: signatures, layouts and register slices."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

__all__ = ["AxiStreamSignature", "HalfSlice", "PacketLayout", "RegisterSlice", "ReverseSlice"]


class AxiStreamSignature(wiring.Signature):
    """AXI4-Stream with TKEEP and TLAST, as the transmitter sees it.

    Parameters
    ----------
    bytes
        Bytes of TDATA.
    """

    def __init__(self, bytes: int):
        self.bytes = bytes
        super().__init__(
            {
                "tdata": Out(8 * bytes),
                "tkeep": Out(bytes),
                "tlast": Out(1),
                "tvalid": Out(1),
                "tready": In(1),
            }
        )


class PacketLayout(data.StructLayout):
    """A word of a packet: its bits, whether all its bytes are there, and whether it is the last."""

    def __init__(self, payload):
        super().__init__({"data": payload, "whole": 1, "last": 1})


class _Slice(wiring.Component):
    """A stream cut by registers.

    Parameters
    ----------
    shape
        Shape of the payload.

    Members
    -------
    i : In(stream of shape), o : Out(stream of shape)
        The two sides.
    """

    def __init__(self, shape):
        self.shape = shape
        super().__init__({"i": In(stream.Signature(shape)), "o": Out(stream.Signature(shape))})


class RegisterSlice(_Slice):
    """A stream cut by registers in both directions, at its full rate.

    It is a skid buffer: one payload is offered, and a second one is stored while the first waits.

    **Latency**: 1 cycle. **Throughput**: a payload a cycle. See ``_Slice`` for parameters and
    members.
    """

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        valid = Signal()
        spare = Signal()
        offered = Signal(self.shape, reset_less=True)
        waiting = Signal(self.shape, reset_less=True)
        m.d.comb += [
            self.i.ready.eq(~spare),
            self.o.valid.eq(valid),
            self.o.payload.eq(offered),
        ]
        with m.If(~valid | self.o.ready):
            m.d.sync += [valid.eq(self.i.valid | spare), spare.eq(0)]
            with m.If(spare):
                m.d.sync += offered.eq(waiting)
            with m.Else():
                m.d.sync += offered.eq(self.i.payload)
        with m.Elif(self.i.valid):
            m.d.sync += spare.eq(1)
        with m.If(~spare):
            m.d.sync += waiting.eq(self.i.payload)
        return m


class HalfSlice(_Slice):
    """A stream cut by registers in both directions, at half the rate, with half the registers.

    **Latency**: 1 cycle. **Throughput**: a payload in two cycles. See ``_Slice`` for parameters
    and members.
    """

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        valid = Signal()
        offered = Signal(self.shape, reset_less=True)
        m.d.comb += [
            self.i.ready.eq(~valid),
            self.o.valid.eq(valid),
            self.o.payload.eq(offered),
        ]
        with m.If(valid):
            m.d.sync += valid.eq(~self.o.ready)
        with m.Else():
            m.d.sync += [valid.eq(self.i.valid), offered.eq(self.i.payload)]
        return m


class ReverseSlice(_Slice):
    """A stream whose ``ready`` is cut by a register, at its full rate.

    A payload passes while the next component is ready. Otherwise it is stored. ``o.ready`` leads to
    one flip-flop, so it may come late in a cycle.

    **Latency**: 0. **Throughput**: a payload a cycle. See ``_Slice`` for parameters and members.
    """

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        full = Signal()
        waiting = Signal(self.shape, reset_less=True)
        m.d.comb += [
            self.i.ready.eq(~full),
            self.o.valid.eq(self.i.valid | full),
            self.o.payload.eq(
                Mux(full, Value.cast(waiting), Value.cast(self.i.payload)),
            ),
        ]
        m.d.sync += full.eq(self.o.valid & ~self.o.ready)
        with m.If(~full):
            m.d.sync += waiting.eq(self.i.payload)
        return m
