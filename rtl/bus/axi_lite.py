"""The AXI4-Lite port: turns five channels into single reads and writes."""

from __future__ import annotations

from enum import IntEnum

from amaranth.hdl import Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

__all__ = ["AxiLiteFront", "AxiLiteSignature", "Response", "WriteLayout"]


class Response(IntEnum):
    """Responses of a slave (Arm IHI 0022, "Read and write response structure")."""

    OKAY = 0
    SLVERR = 2
    DECERR = 3


class AxiLiteSignature(wiring.Signature):
    """AXI4-Lite with 32 bits of data, as the master sees it.

    Parameters
    ----------
    address_bits
        Bits of an address.
    """

    def __init__(self, address_bits: int):
        self.address_bits = address_bits
        super().__init__(
            {
                "awaddr": Out(address_bits),
                "awprot": Out(3),
                "awvalid": Out(1),
                "awready": In(1),
                "wdata": Out(32),
                "wstrb": Out(4),
                "wvalid": Out(1),
                "wready": In(1),
                "bresp": In(2),
                "bvalid": In(1),
                "bready": Out(1),
                "araddr": Out(address_bits),
                "arprot": Out(3),
                "arvalid": Out(1),
                "arready": In(1),
                "rdata": In(32),
                "rresp": In(2),
                "rvalid": In(1),
                "rready": Out(1),
            }
        )


class WriteLayout(data.StructLayout):
    """A write: address, data, and which bytes of the data are written."""

    def __init__(self, address_bits: int):
        super().__init__({"address": address_bits, "data": 32, "strobe": 4})


class AxiLiteFront(wiring.Component):
    """Takes one write and one read at a time, and answers them.

    Every output to the bus is a register: no combinational path leads from an input of the bus to
    an output. ``awprot`` and ``arprot`` are ignored.

    **Latency**: 1 cycle from the later one of a write's address and data to ``write_valid``, 1 from
    a read's address to ``read_valid``; 1 from the response to the bus. **Throughput**: one read and
    one write in three cycles.

    Parameters
    ----------
    address_bits
        Bits of an address.

    Members
    -------
    bus : In(AxiLiteSignature)
        The port.
    write : Out(WriteLayout), write_valid : Out(1)
        A write; steady until ``write_done``.
    write_done : In(1), write_response : In(2)
        The write is done, or refused, in this cycle.
    read : Out(address_bits), read_valid : Out(1)
        A read.
    read_data : In(32), read_response : In(2)
        Its response, in the same cycle.
    """

    def __init__(self, address_bits: int):
        super().__init__(
            {
                "bus": In(AxiLiteSignature(address_bits)),
                "write": Out(WriteLayout(address_bits)),
                "write_valid": Out(1),
                "write_done": In(1),
                "write_response": In(2),
                "read": Out(address_bits),
                "read_valid": Out(1),
                "read_data": In(32),
                "read_response": In(2),
            }
        )

    def elaborate(self, platform):
        """Build the circuit."""
        m = Module()
        bus = self.bus
        addressed = Signal()
        given = Signal()
        answered = Signal()
        write = Signal(self.write.shape(), reset_less=True)
        write_response = Signal(2, reset_less=True)
        m.d.comb += [
            bus.awready.eq(~addressed),
            bus.wready.eq(~given),
            bus.bvalid.eq(answered),
            bus.bresp.eq(write_response),
            self.write.eq(write),
            self.write_valid.eq(addressed & given & ~answered),
        ]
        with m.If(bus.awvalid & ~addressed):
            m.d.sync += [addressed.eq(1), write.address.eq(bus.awaddr)]
        with m.If(bus.wvalid & ~given):
            m.d.sync += [given.eq(1), write.data.eq(bus.wdata), write.strobe.eq(bus.wstrb)]
        with m.If(answered & bus.bready):
            m.d.sync += answered.eq(0)
        with m.If(self.write_valid & self.write_done):
            m.d.sync += [
                addressed.eq(0),
                given.eq(0),
                answered.eq(1),
                write_response.eq(self.write_response),
            ]

        asked = Signal()
        told = Signal()
        address = Signal(len(self.read), reset_less=True)
        read_data = Signal(32, reset_less=True)
        read_response = Signal(2, reset_less=True)
        m.d.comb += [
            bus.arready.eq(~asked),
            bus.rvalid.eq(told),
            bus.rdata.eq(read_data),
            bus.rresp.eq(read_response),
            self.read.eq(address),
            self.read_valid.eq(asked & ~told),
        ]
        with m.If(bus.arvalid & ~asked):
            m.d.sync += [asked.eq(1), address.eq(bus.araddr)]
        with m.If(told & bus.rready):
            m.d.sync += told.eq(0)
        with m.If(self.read_valid):
            m.d.sync += [
                asked.eq(0),
                told.eq(1),
                read_data.eq(self.read_data),
                read_response.eq(self.read_response),
            ]
        return m
