"""The cocotb side of a simulated board: executes commands inside the simulator.

The serial link is driven by cocotbext-uart, whose models are independent of this project and of
LiteX. Commands come from :mod:`splatline.sim.cosim.board.board_device`.
"""

from __future__ import annotations

import os
from typing import Any

import cocotb
from cocotb.triggers import Timer
from cocotbext.uart import UartSink, UartSource  # type: ignore[import-untyped]

from splatline.sim.cosim.served import connect, serve_commands

__all__ = ["BoardBench", "serve"]

RESET_NS = 500
"""Length of a reset."""

TICK_NS = 1000
"""Time between two looks at the serial line."""


@cocotb.test()
async def serve(dut: Any) -> None:
    """Execute the commands from the socket until it closes."""
    with connect() as line:
        bench = BoardBench(dut, int(os.environ["SPLATLINE_BAUD"]))
        await bench.reset()
        await serve_commands(line, bench)


class BoardBench:
    """Models around the pins of a board."""

    def __init__(self, dut: Any, baud: int) -> None:
        self.dut = dut
        dut.record.value = 0
        self.source = UartSource(dut.serial_rx, baud=baud)
        self.sink = UartSink(dut.serial_tx, baud=baud)

    async def reset(self) -> None:
        """Hold the reset for a while; what was sent and not received is lost."""
        self.dut.rst.value = 1
        await Timer(RESET_NS, "ns")
        self.dut.rst.value = 0
        await Timer(RESET_NS, "ns")
        self.sink.clear()

    async def write(self, data: bytes) -> None:
        """Send bytes over the serial link, and wait for the last one."""
        self.source.write_nowait(data)
        await self.source.wait()

    async def read(self, count: int, limit_ns: int) -> bytes:
        """Return so many bytes from the serial link, or less if they do not come in time."""
        waited = 0
        while self.sink.count() < count and waited < limit_ns:
            await Timer(TICK_NS, "ns")
            waited += TICK_NS
        return bytes(self.sink.read_nowait(min(count, self.sink.count())))

    async def wait(self, nanoseconds: int) -> None:
        """Let time pass."""
        await Timer(nanoseconds, "ns")

    async def record(self, on: bool) -> int:
        """Begin or end the record of the pins; return the bits of the last record."""
        self.dut.record.value = int(on)
        await Timer(1, "ns")
        return int(self.dut.bits.value)

    async def violations(self) -> int:
        """Return the rules of the SDRAM chip that were broken so far; in the ULX3S bench alone."""
        return int(self.dut.violations.value)
