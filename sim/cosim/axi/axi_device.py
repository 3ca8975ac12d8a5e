"""A device that is a simulation: the engine's Verilog on its buses, in a process of its own.

It has the interface of a board (:class:`splatline.host.device.device.Device`), so what is written
for one runs on the other. Each command goes to :mod:`splatline.sim.cosim.axi.axi_bench` inside the
simulator and comes back answered.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import socket
import subprocess
import sys
import tempfile
import time
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import PAPER
from splatline.contract.register_map import raster_stream_bytes
from splatline.host.device.device import BusError, DeviceTimeoutError
from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import Build, SimulationError

__all__ = ["SimulatedDevice", "build_axi"]

START_SECONDS = 120.0
"""How long a simulator may take to start: a machine may have much else to do."""

VISIBLE = [
    ("splatline.engine", name)
    for name in (
        *("codewords__valid", "codewords__ready"),
        *("raster__valid", "raster__ready", "raster__payload"),
    )
]
"""What the bench reads inside: where code words enter the engine, and where beats leave it."""

_SERVE = "import sys; from splatline.sim.cosim.axi.axi_device import serve; serve(sys.argv[1])"


def build_axi(config: EngineConfig = PAPER, simulator_name: str = "verilator") -> Build:
    """Build the simulator of an engine on its buses, or find it built."""
    from splatline.flow.verilog import convert
    from splatline.rtl.bus.axi_top import AxiTop

    text = convert(AxiTop(config), "splatline")
    return simulator.build(
        {"splatline.v": text}, "splatline", simulator=simulator_name, visible=VISIBLE
    )


class SimulatedDevice:
    """A simulator with an engine on its buses; use it in a ``with``, or call :meth:`close`.

    Parameters
    ----------
    config
        The engine's configuration.
    stall
        Share of the cycles, 0..1 without 1, in which each channel of each bus is held back.
    seed
        Of the stalls.
    limit
        Cycles after which :meth:`receive` gives up.
    built
        What to run instead of the configuration's own build, such as a broken one.

    Raises
    ------
    InputError
        If the simulator or cocotbext-axi is not installed.
    SimulationError
        If it cannot be built or started; from every method, if it stops.
    """

    def __init__(
        self,
        config: EngineConfig = PAPER,
        *,
        stall: float = 0.0,
        seed: int = 1,
        limit: int = 1_000_000,
        built: Build | None = None,
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
            self._process, self._line = self._start(stack, Path(scratch), built)
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
        """Have a method of ``AxiBench`` called in the simulator, and return what it returned."""
        try:
            self._line.send((name, *arguments))
            while not self._line.poll(1.0):
                if self._process.poll() is not None:
                    raise EOFError
            return self._line.recv()
        except (EOFError, OSError) as error:
            _end(self._process)  # so that its log is whole
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
        self, stack: contextlib.ExitStack, scratch: Path, built: Build
    ) -> tuple[subprocess.Popen[bytes], Connection[Any, Any]]:
        """Start the simulator, and wait until it has called."""
        address = scratch / "socket"
        job = {
            "folder": str(built.folder),
            "top": built.top,
            "simulator": built.simulator,
            "socket": str(address),
        }
        listener = stack.enter_context(socket.socket(socket.AF_UNIX))
        listener.bind(str(address))
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
        """Return what the simulator said last."""
        return self._log.read_text(errors="replace")[-4000:]


_RESPONSES = {2: "SLVERR", 3: "DECERR"}


def _end(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process whose line was closed; end it if it does not."""
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.terminate()
        process.wait()


def serve(job: str) -> None:
    """Run the simulator: what the process of a :class:`SimulatedDevice` does."""
    told = json.loads(job)
    simulator.run(
        Build(Path(told["folder"]), told["top"], told["simulator"], reused=True),
        f"{__package__}.axi_bench",
        environment={"SPLATLINE_SOCKET": told["socket"], "COCOTB_LOG_LEVEL": "WARNING"},
    )
