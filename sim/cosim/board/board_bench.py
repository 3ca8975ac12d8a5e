"""The cocotb side of a simulated board: executes commands inside the simulator.

The serial link is driven by cocotbext-uart, and Ethernet by cocotbext-eth, whose models are
independent of this project and of LiteX. Commands come from
:mod:`splatline.sim.cosim.board.board_device`.
"""

from __future__ import annotations

import os
from typing import Any

import cocotb
from cocotb.triggers import Timer
from cocotb.utils import get_sim_time
from cocotbext.eth import GmiiFrame, RgmiiSink, RgmiiSource  # type: ignore[import-untyped]
from cocotbext.uart import UartSink, UartSource  # type: ignore[import-untyped]

from splatline.sim.cosim.served import connect, serve_commands

__all__ = ["BoardBench", "EthernetBench", "SerialBench", "serve"]

RESET_NS = 500
"""Length of a reset."""

TICK_NS = 1000
"""Time between two looks at the link."""


@cocotb.test()
async def serve(dut: Any) -> None:
    """Execute the commands from the socket until it closes."""
    with connect() as line:
        ethernet = hasattr(dut, "eth_rx_clk")
        bench = EthernetBench(dut) if ethernet else SerialBench(dut)
        await bench.reset()
        await serve_commands(line, bench)


class BoardBench:
    """Clocks, reset and HDMI pins of a board; what drives its link has the model ``sink``."""

    sink: Any

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        dut.record.value = 0

    async def reset(self) -> None:
        """Hold the reset for a while; what was sent and not received is lost."""
        self.dut.rst.value = 1
        await Timer(RESET_NS, "ns")
        self.dut.rst.value = 0
        await Timer(RESET_NS, "ns")
        self.sink.clear()

    async def wait(self, nanoseconds: int) -> None:
        """Let time pass."""
        await Timer(nanoseconds, "ns")

    async def time(self) -> float:
        """Return the time of the simulation in ns."""
        return float(get_sim_time("ns"))

    async def record(self, on: bool) -> int:
        """Begin or end the record of the pins; return the bits of the last record."""
        self.dut.record.value = int(on)
        await Timer(1, "ns")
        return int(self.dut.bits.value)

    async def violations(self) -> int:
        """Return the rules of the SDRAM chip that were broken so far; in the ULX3S bench alone."""
        return int(self.dut.violations.value)

    async def _until(self, count: int, limit_ns: int) -> None:
        """Wait until the link has received so many bytes or frames, or a time is over."""
        waited = 0
        while self.sink.count() < count and waited < limit_ns:
            await Timer(TICK_NS, "ns")
            waited += TICK_NS


class SerialBench(BoardBench):
    """A board with a serial link."""

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        baud = int(os.environ["SPLATLINE_BAUD"])
        self.source = UartSource(dut.serial_rx, baud=baud)
        self.sink = UartSink(dut.serial_tx, baud=baud)

    async def write(self, data: bytes) -> None:
        """Send bytes over the serial link, and wait for the last one."""
        self.source.write_nowait(data)
        await self.source.wait()

    async def read(self, count: int, limit_ns: int) -> bytes:
        """Return so many bytes from the serial link, or less if they do not come in time."""
        await self._until(count, limit_ns)
        return bytes(self.sink.read_nowait(min(count, self.sink.count())))


class EthernetBench(BoardBench):
    """A board with gigabit Ethernet, from RGMII on."""

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        self.source = RgmiiSource(dut.eth_rx_data, dut.eth_rx_ctl, dut.eth_rx_clk)
        self.sink = RgmiiSink(dut.eth_tx_data, dut.eth_tx_ctl, dut.eth_tx_clk)

    async def send_frame(self, frame: bytes, sent: int | None) -> None:
        """Send a frame, padded to its least length and with a check sequence.

        ``sent``: bytes of it that are sent, preamble included, before the cable is pulled out.
        """
        made = GmiiFrame.from_payload(frame)
        if sent is not None:
            made = GmiiFrame(made.data[:sent])
        await self.source.send(made)
        await self.source.wait()

    async def receive_frame(self, limit_ns: int) -> bytes:
        """Return the next frame; nothing if none comes in time, or its check sequence is wrong."""
        await self._until(1, limit_ns)
        if self.sink.empty():
            return b""
        frame = self.sink.recv_nowait()
        return bytes(frame.get_payload()) if frame.check_fcs() else b""
