"""A simulated device: the Verilog of the AXI top, in a simulator process of its own.

It has the interface of a board (:class:`splatline.host.device.device.Device`), so the driver works
with both. Each command is executed by :mod:`splatline.sim.cosim.axi.axi_bench` inside the
simulator, which sends back the result.
"""

from __future__ import annotations

import contextlib
import functools
import importlib.util
import json
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import DEFAULT
from splatline.host.device.device import BusError, DeviceTimeoutError
from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import Build, SimulationError

__all__ = ["SimulatedDevice", "build_axi"]

START_SECONDS = 120.0
"""Longest time that a simulator may take to start, on a busy machine."""

VISIBLE = [
    ("splatline__engine", name)
    for name in (
        *("codewords__valid", "codewords__ready"),
        *("raster__valid", "raster__ready", "raster__payload"),
    )
]
"""Internal signals that the bench reads: the engine's streams of code words and raster beats."""

_SERVE = "import sys; from splatline.sim.cosim.axi.axi_device import serve; serve(sys.argv[1])"


def build_axi(
    config: EngineConfig = DEFAULT,
    simulator_name: str = "verilator",
    *,
    edit: Callable[[str], str] = lambda text: text,
    options: Sequence[str] = (),
) -> Build:
    """Build the simulator of an AXI top, or return its cached build.

    ``edit`` changes the Verilog, such as to plant a fault. ``options`` are the simulator's.
    """
    return simulator.build(
        {"splatline.v": edit(_verilog(config))},
        "splatline",
        simulator=simulator_name,
        visible=VISIBLE,
        options=options,
    )


@functools.cache
def _verilog(config: EngineConfig) -> str:
    """Return the Verilog of an AXI top, converted once in a process."""
    from splatline.flow.verilog import convert
    from splatline.rtl.bus.axi_top import AxiTop

    return convert(AxiTop(config), "splatline")


class SimulatedDevice:
    """A simulator of an AXI top; use it in a ``with``, or call :meth:`close`.

    Parameters
    ----------
    config
        The engine's configuration.
    stall
        Share of the cycles, 0..1 without 1, in which each channel of each bus stalls.
    seed
        Seed of the random stalls.
    limit
        Cycles after which :meth:`receive` gives up.
    built
        Build to use instead of the configuration's own, such as one with a planted fault.
    reset_edges
        Clock edges of the reset before the first command.
    plusargs
        Arguments for the Verilog, such as ``+fault=1``.

    Raises
    ------
    InputError
        If the simulator or cocotbext-axi is not installed.
    SimulationError
        If it cannot be built or started; raised by every method if the simulator stops.
    """

    def __init__(
        self,
        config: EngineConfig = DEFAULT,
        *,
        stall: float = 0.0,
        seed: int = 1,
        limit: int = 1_000_000,
        built: Build | None = None,
        reset_edges: int = 4,
        plusargs: Sequence[str] = (),
    ) -> None:
        if not 0.0 <= stall < 1.0:
            raise ValueError(f"stall must be in 0..1 without 1, not {stall}")
        if importlib.util.find_spec("cocotbext") is None:
            raise InputError(
                f"an engine on AXI is simulated with cocotbext-axi: {install_hint('cosim')}"
            )
        self.config = config
        self.limit = limit
        built = build_axi(config) if built is None else built
        with contextlib.ExitStack() as stack:
            scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="splatline-"))
            self._log = Path(scratch) / "log"
            job = {
                "folder": str(built.folder),
                "top": built.top,
                "simulator": built.simulator,
                "socket": str(Path(scratch) / "socket"),
                "reset_edges": reset_edges,
                "plusargs": list(plusargs),
            }
            self._process, self._line = self._start(stack, job)
            self._stack = stack.pop_all()
        if stall:
            self.command("stall", stall, seed)

    def read32(self, offset: int) -> int:
        """Read a register."""
        value, response = self.command("read", offset)
        if response:
            raise BusError(f"the read at {offset:#x} was refused ({_RESPONSES[response]})")
        return int(value)

    def write32(self, offset: int, value: int) -> None:
        """Write a register."""
        response = self.command("write", offset, value.to_bytes(4, "little"))
        if response:
            raise BusError(f"the write at {offset:#x} was refused ({_RESPONSES[response]})")

    def send(
        self, codewords: npt.NDArray[np.uint64], initial: npt.NDArray[np.uint64] | None = None
    ) -> None:
        """Offer a packet of code words, and one of an initial raster."""
        if initial is not None:
            self.command("send", "initial", initial.astype("<u8").tobytes(), None)
        self.command("send", "codewords", codewords.astype("<u8").tobytes(), None)

    def receive(self) -> npt.NDArray[np.uint64]:
        """Wait for a packet of the raster."""
        data = self.command("receive", self.limit)
        broken = self.command("rules")
        if broken:
            raise SimulationError(f"the engine broke a rule of its buses: {broken[0]}")
        if data is None:
            raise DeviceTimeoutError(f"no end beat after {self.limit} cycles")
        return np.frombuffer(data, "<u8").reshape(-1, raster_stream_bytes(self.config) // 8)

    def command(self, name: str, *arguments: object) -> Any:
        """Call a method of ``AxiBench`` in the simulator; return its result."""
        try:
            self._line.send((name, *arguments))
            while not self._line.poll(1.0):
                if self._process.poll() is not None:
                    raise EOFError
            return self._line.recv()
        except (EOFError, OSError) as error:
            _end(self._process)  # its log is then complete
            raise SimulationError(f"the simulator stopped\n{self._tail()}") from error

    def close(self) -> None:
        """End the simulator."""
        self._stack.close()

    def __enter__(self) -> SimulatedDevice:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _start(
        self, stack: contextlib.ExitStack, job: dict[str, Any]
    ) -> tuple[subprocess.Popen[bytes], Connection[Any, Any]]:
        """Start the simulator; return its process and the connection to it."""
        listener = stack.enter_context(socket.socket(socket.AF_UNIX))
        listener.bind(job["socket"])
        listener.listen(1)
        listener.settimeout(0.2)
        log = stack.enter_context(self._log.open("wb"))
        process = subprocess.Popen(
            [sys.executable, "-c", _SERVE, json.dumps(job)], stdout=log, stderr=log
        )
        stack.callback(_end, process)
        latest = time.monotonic() + START_SECONDS
        while True:
            try:
                end, _ = listener.accept()
                break
            except TimeoutError:
                if process.poll() is not None or time.monotonic() > latest:
                    raise SimulationError(f"the simulator did not start\n{self._tail()}") from None
        end.setblocking(True)
        line: Connection[Any, Any] = stack.enter_context(Connection(end.detach()))
        try:
            line.recv()
        except EOFError:
            raise SimulationError(f"the simulator stopped at once\n{self._tail()}") from None
        return process, line

    def _tail(self) -> str:
        """Return the end of the simulator's log."""
        return self._log.read_text(errors="replace")[-4000:]


_RESPONSES = {2: "SLVERR", 3: "DECERR"}


def _end(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process whose connection was closed; terminate it if it does not end."""
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.terminate()
        process.wait()


def serve(job: str) -> None:
    """Run the simulator, in the process that a :class:`SimulatedDevice` starts."""
    told = json.loads(job)
    simulator.run(
        Build(Path(told["folder"]), told["top"], told["simulator"], reused=True),
        f"{__package__}.axi_bench",
        plusargs=told["plusargs"],
        environment={
            "SPLATLINE_SOCKET": told["socket"],
            "SPLATLINE_RESET_EDGES": str(told["reset_edges"]),
            "COCOTB_LOG_LEVEL": "WARNING",
        },
    )
