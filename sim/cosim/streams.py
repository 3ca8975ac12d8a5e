"""Sources and sinks for Amaranth streams in cocotb, each with random stalls of its own."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.handle import LogicObject
from cocotb.triggers import FallingEdge, ReadOnly
from cocotb.types import Logic, LogicArray

__all__ = ["Sink", "Source", "StreamBench", "StreamRuleError", "undefined"]


class StreamRuleError(AssertionError):
    """A breach of the rules of valid/ready streams, or a bench that ran out of cycles."""


def undefined(port: Any, numbers: random.Random) -> Logic | LogicArray | int:
    """Return a value for an idle port: X, or a random number in a simulator without X."""
    if cocotb.SIM_NAME.lower().startswith("verilator"):
        return numbers.getrandbits(len(port))
    return Logic("X") if isinstance(port, LogicObject) else LogicArray("X" * len(port))


@dataclass
class Source:
    """Source that offers payloads in order; an offered payload stays until it is taken."""

    name: str
    payloads: Sequence[int]
    rate: float
    sent: int = 0
    offering: bool = False
    idle: bool = False


@dataclass
class Sink:
    """Sink that takes a port's payloads and checks that the port keeps to the stream rules."""

    name: str
    rate: float
    received: list[int] = field(default_factory=list)
    waiting: int | None = None


class StreamBench:
    """Driver of a component's streams and plain ports, cycle by cycle.

    Inputs are driven at the falling edge. Outputs are sampled after they have settled, before the
    rising edge. The order of events within an edge, on which simulators differ, has no influence.

    Parameters
    ----------
    dut
        Top module of the simulation, with ports ``clk``, ``rst`` and streams as Amaranth names
        them.
    seed
        Seed of the random stalls.
    """

    def __init__(self, dut: Any, seed: int) -> None:
        self.dut = dut
        self.random = random.Random(seed)
        self.sources: list[Source] = []
        self.sinks: list[Sink] = []
        self.cycles = 0

    async def reset(self) -> None:
        """Start the clock and reset for two cycles, with all streams idle."""
        if not self.cycles:
            Clock(self.dut.clk, 10, unit="ns").start()
        for source in self.sources:
            payload = self._port(source.name, "payload")
            self._port(source.name, "valid").value = 0
            payload.value = undefined(payload, self.random)
        for sink in self.sinks:
            self._port(sink.name, "ready").value = 0
        if hasattr(self.dut, "rst"):
            self.dut.rst.value = 1
            await FallingEdge(self.dut.clk)
            await FallingEdge(self.dut.clk)
            self.dut.rst.value = 0
        else:
            await FallingEdge(self.dut.clk)
        self.cycles += 2

    def source(self, name: str, payloads: Iterable[int], rate: float = 1.0) -> Source:
        """Add a source on a stream; ``rate`` is the share of cycles in which it may offer."""
        self.sources.append(Source(name, list(payloads), rate))
        return self.sources[-1]

    def sink(self, name: str, rate: float = 1.0) -> Sink:
        """Add a sink on a stream; ``rate`` is the share of cycles in which it is ready."""
        self.sinks.append(Sink(name, rate))
        return self.sinks[-1]

    async def step(
        self,
        drive: Callable[[], None] | None = None,
        observe: Callable[[], None] | None = None,
    ) -> None:
        """Run one cycle; ``drive`` sets plain ports for it, ``observe`` reads them when settled."""
        for source in self.sources:
            self._offer(source)
        for sink in self.sinks:
            self._port(sink.name, "ready").value = self.random.random() < sink.rate
        if drive is not None:
            drive()
        await ReadOnly()
        for source in self.sources:
            if source.offering and int(self._port(source.name, "ready").value):
                source.sent += 1
                source.offering = False
        for sink in self.sinks:
            self._take(sink)
        if observe is not None:
            observe()
        self.cycles += 1
        await FallingEdge(self.dut.clk)

    async def run(
        self,
        done: Callable[[], bool],
        *,
        most_cycles: int,
        drive: Callable[[], None] | None = None,
        observe: Callable[[], None] | None = None,
        after: int = 8,
    ) -> int:
        """Run until ``done``, then ``after`` more cycles to catch outputs that must not follow.

        Returns
        -------
        int
            Number of cycles until ``done``.

        Raises
        ------
        StreamRuleError
            If ``done`` stays false for ``most_cycles``.
        """
        begin = self.cycles
        while not done():
            if self.cycles - begin >= most_cycles:
                sent = {source.name: source.sent for source in self.sources}
                received = {sink.name: len(sink.received) for sink in self.sinks}
                raise StreamRuleError(
                    f"not done after {most_cycles} cycles; sent {sent}, received {received}"
                )
            await self.step(drive, observe)
        needed = self.cycles - begin
        for _ in range(after):
            await self.step(drive, observe)
        return needed

    def _port(self, stream: str, part: str) -> Any:
        return getattr(self.dut, f"{stream}__{part}")

    def _offer(self, source: Source) -> None:
        if source.offering:
            return
        offers = source.sent < len(source.payloads) and self.random.random() < source.rate
        source.offering = offers
        self._port(source.name, "valid").value = offers
        payload = self._port(source.name, "payload")
        if offers:
            payload.value = source.payloads[source.sent]
            source.idle = False
        elif not source.idle:  # an idle payload stays what it is
            payload.value = undefined(payload, self.random)
            source.idle = True

    def _take(self, sink: Sink) -> None:
        valid = int(self._port(sink.name, "valid").value)
        payload = int(self._port(sink.name, "payload").value) if valid else None
        if sink.waiting is not None and payload != sink.waiting:
            raise StreamRuleError(f"{sink.name}: a payload changed or went before it was taken")
        sink.waiting = payload
        if valid and int(self._port(sink.name, "ready").value):
            assert payload is not None
            sink.received.append(payload)
            sink.waiting = None
