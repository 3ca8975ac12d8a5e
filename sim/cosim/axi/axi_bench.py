"""The cocotb side of a simulated AXI top: executes commands inside the simulator.

The buses are driven by cocotbext-axi, whose bus models are independent of this project. Commands
come from :mod:`splatline.sim.cosim.axi.axi_device` (:mod:`splatline.sim.cosim.served`).
"""

from __future__ import annotations

import itertools
import os
import random
from collections.abc import Iterator
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.task import Task
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotbext.axi import (  # type: ignore[import-untyped]
    AxiLiteBus,
    AxiLiteMaster,
    AxiStreamBus,
    AxiStreamFrame,
    AxiStreamSink,
    AxiStreamSource,
)

from splatline.sim.cosim.served import connect, serve_commands
from splatline.sim.cosim.streams import undefined

__all__ = ["AxiBench", "serve"]

PERIOD_NS = 10
"""Clock period."""

TICK = 16
"""Cycles between two polls for a received packet."""

CHANNELS = (
    ("s_axi_ctrl_b", ("bresp",)),
    ("s_axi_ctrl_r", ("rdata", "rresp")),
    ("m_axis_raster_t", ("tdata", "tkeep", "tlast")),
)
"""The engine's output channels: prefix of valid and ready, and payload that must stay stable."""

IDLE = (
    ("s_axi_ctrl_aw", ("addr", "prot")),
    ("s_axi_ctrl_w", ("data", "strb")),
    ("s_axi_ctrl_ar", ("addr", "prot")),
    ("s_axis_codewords_t", ("data", "keep", "last")),
    ("s_axis_initial_t", ("data", "keep", "last")),
)
"""The engine's input channels: prefix of valid, and payload, which is undefined while not valid."""

INPUTS = (
    *(f"s_axi_ctrl_{name}" for name in ("awaddr", "awprot", "awvalid", "wdata", "wstrb", "wvalid")),
    *(f"s_axi_ctrl_{name}" for name in ("bready", "araddr", "arprot", "arvalid", "rready")),
    *(f"s_axis_codewords_{name}" for name in ("tdata", "tkeep", "tlast", "tvalid")),
    *(f"s_axis_initial_{name}" for name in ("tdata", "tkeep", "tlast", "tvalid")),
    "m_axis_raster_tready",
)
OUTPUTS = (
    *(f"s_axi_ctrl_{name}" for name in ("awready", "wready", "bresp", "bvalid")),
    *(f"s_axi_ctrl_{name}" for name in ("arready", "rdata", "rresp", "rvalid")),
    "s_axis_codewords_tready",
    "s_axis_initial_tready",
    *(f"m_axis_raster_{name}" for name in ("tdata", "tkeep", "tlast", "tvalid")),
    "irq",
)


@cocotb.test()
async def serve(dut: Any) -> None:
    """Execute the commands from the socket until it closes."""
    with connect() as line:
        bench = AxiBench(dut)
        await bench.reset(int(os.environ["SPLATLINE_RESET_EDGES"]))
        await serve_commands(line, bench)


class AxiBench:
    """Bus models around an ``AxiTop``, with monitors of the bus rules."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        common = (dut.aclk, dut.aresetn, False)
        self.master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axi_ctrl"), *common)
        self.sources = {
            name: AxiStreamSource(AxiStreamBus.from_prefix(dut, f"s_axis_{name}"), *common)
            for name in ("codewords", "initial")
        }
        self.sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis_raster"), *common)
        self.random = random.Random(1)
        self.breaches: list[str] = []
        self.raster = [0, 0]
        self.engine = [0, 0]
        self.engine_watch: Task[None] | None = None
        dut.aresetn.value = 0
        Clock(dut.aclk, PERIOD_NS, unit="ns").start()
        for prefix, parts in IDLE:
            cocotb.start_soon(self._undefine(prefix, [f"{prefix}{part}" for part in parts]))
        cocotb.start_soon(self._watch())

    async def reset(self, edges: int = 4) -> None:
        """Hold the reset for some clock edges."""
        self.dut.aresetn.value = 0
        await FallingEdge(self.dut.aclk)
        await ClockCycles(self.dut.aclk, edges)
        self.dut.aresetn.value = 1
        await ClockCycles(self.dut.aclk, 2)

    async def read(self, offset: int, size: int = 4) -> tuple[int, int]:
        """Return some bytes of a register, as a number, and the bus's response code."""
        done = await self.master.read(offset, size)
        return int.from_bytes(done.data, "little"), int(done.resp)

    async def write(self, offset: int, data: bytes) -> int:
        """Write bytes at an offset; return the bus's response code, the worst of several."""
        return int((await self.master.write(offset, data)).resp)

    async def together(
        self, reads: list[int], writes: list[tuple[int, bytes]]
    ) -> tuple[list[tuple[int, int]], list[int]]:
        """Issue reads and writes concurrently, each in order.

        Returns the results of :meth:`read` for each read, and of :meth:`write` for each write.
        """
        reading = [self.master.init_read(offset, 4) for offset in reads]
        writing = [self.master.init_write(offset, data) for offset, data in writes]
        for event in (*reading, *writing):
            await event.wait()
        return (
            [(int.from_bytes(e.data.data, "little"), int(e.data.resp)) for e in reading],
            [int(event.data.resp) for event in writing],
        )

    async def send(self, name: str, data: bytes, keep: bytes | None) -> None:
        """Queue a packet on a stream; ``keep`` has TKEEP of each byte."""
        frame = AxiStreamFrame(data, tkeep=None if keep is None else list(keep))
        self.sources[name].send_nowait(frame)

    async def receive(self, cycles: int) -> bytes | None:
        """Wait for a packet of the raster; return None after so many cycles without one."""
        waited = 0
        while self.sink.empty() and waited < cycles:
            await ClockCycles(self.dut.aclk, TICK)
            waited += TICK
        return None if self.sink.empty() else bytes(self.sink.recv_nowait(compact=False).tdata)

    async def wait(self, cycles: int) -> None:
        """Wait for some cycles."""
        await ClockCycles(self.dut.aclk, cycles)

    async def irq(self) -> int:
        """Return the level of the interrupt."""
        return int(self.dut.irq.value)

    async def pause(self, name: str, pause: bool) -> None:
        """Pause or resume a stream: ``codewords``, ``initial`` or ``raster``."""
        (self.sink if name == "raster" else self.sources[name]).pause = pause

    async def forget(self, name: str) -> None:
        """Discard a source's unsent data, as a reset of its DMA does."""
        self.sources[name].assert_reset()

    async def stall(self, rate: float, seed: int) -> None:
        """Stall every channel at random, in this share of the cycles."""
        write, read = self.master.write_if, self.master.read_if
        channels = (
            *(write.aw_channel, write.w_channel, write.b_channel, read.ar_channel, read.r_channel),
            *(*self.sources.values(), self.sink),
        )
        for number, channel in enumerate(channels):
            channel.clear_pause_generator()
            channel.pause = False
            if rate:
                channel.set_pause_generator(_pauses(rate, f"{seed}/{number}"))

    async def rules(self) -> list[str]:
        """Return the breaches of the buses' rules so far."""
        return self.breaches

    async def raster_cycles(self) -> tuple[int, int]:
        """Return since the last call the cycles with a beat taken, and with a beat waiting."""
        counted, self.raster = self.raster, [0, 0]
        return counted[0], counted[1]

    async def watch_engine(self) -> None:
        """Start the counters of :meth:`engine_cycles`."""
        self.engine = [0, 0]
        self.engine_watch = cocotb.start_soon(self._watch_engine())

    async def engine_cycles(self) -> tuple[int, int]:
        """Return the cycles in which a frame was open, and in which a code word had to wait."""
        assert self.engine_watch is not None
        self.engine_watch.cancel()
        return self.engine[0], self.engine[1]

    async def turn_over(self, cycles: int) -> list[str]:
        """Invert all inputs in the middle of each cycle; return the outputs that changed.

        The inputs are restored before the next clock edge. AXI forbids combinational paths from
        inputs to outputs, so no output may change.
        """
        inputs = [getattr(self.dut, name) for name in INPUTS]
        outputs = [getattr(self.dut, name) for name in OUTPUTS]
        moved = set()
        for _ in range(cycles):
            await FallingEdge(self.dut.aclk)
            before = [str(port.value) for port in outputs]
            values = [port.value for port in inputs]
            for port, value in zip(inputs, values, strict=True):
                bits = int(value) if value.is_resolvable else self.random.getrandbits(len(port))
                port.value = ~bits & (1 << len(port)) - 1
            await Timer(1, "ns")
            after = [str(port.value) for port in outputs]
            moved |= {n for n, value in enumerate(before) if value != after[n]}
            for port, value in zip(inputs, values, strict=True):
                port.value = value
        return [outputs[n]._name for n in sorted(moved)]

    async def _undefine(self, prefix: str, names: list[str]) -> None:
        """Drive no defined payload while a channel's valid is low."""
        valid, payload = getattr(self.dut, f"{prefix}valid"), [getattr(self.dut, n) for n in names]
        while True:
            for part in payload:
                part.value = undefined(part, self.random)
            await RisingEdge(valid)
            await FallingEdge(valid)

    async def _watch(self) -> None:
        """Record breaches: an offered payload that changes or vanishes before it is taken."""
        channels = [
            (
                prefix,
                getattr(self.dut, f"{prefix}valid"),
                getattr(self.dut, f"{prefix}ready"),
                [getattr(self.dut, f"{prefix[:-1]}{name}") for name in names],
            )
            for prefix, names in CHANNELS
        ]
        reset = self.dut.aresetn
        waiting: list[list[int] | None] = [None] * len(channels)
        edge = RisingEdge(self.dut.aclk)
        while True:
            await edge
            if not int(reset.value):
                waiting = [None] * len(channels)
                continue
            for n, (prefix, valid, ready, payload) in enumerate(channels):
                if int(valid.value):
                    offered = [int(part.value) for part in payload]
                elif waiting[n] is None:
                    continue
                else:
                    offered = None
                if waiting[n] is not None and offered != waiting[n]:
                    self.breaches.append(f"{prefix}valid: {waiting[n]} became {offered}")
                waiting[n] = None if int(ready.value) else offered
                if offered is not None and prefix.startswith("m_axis"):
                    self.raster[waiting[n] is not None] += 1

    async def _watch_engine(self) -> None:
        """Count cycles at the ports of the engine, inside the bus registers.

        A frame is open from its first code word to its end beat, both included.
        """
        inside = self.dut.engine
        ready, valid, beat = inside.raster__ready, inside.raster__valid, inside.raster__payload
        is_open = False
        while True:
            await RisingEdge(self.dut.aclk)
            offered, taken = int(inside.codewords__valid.value), int(inside.codewords__ready.value)
            is_open = is_open or bool(offered and taken)
            self.engine[0] += is_open
            self.engine[1] += offered and not taken
            if int(valid.value) and int(ready.value) and int(beat.value) >> len(beat) - 1:
                is_open = False


def _pauses(rate: float, seed: str) -> Iterator[bool]:
    """Yield for each cycle whether to pause."""
    numbers = random.Random(seed)
    return (numbers.random() < rate for _ in itertools.count())
