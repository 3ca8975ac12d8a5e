"""A simulator in a process of its own that executes commands from this one.

Inside the simulator a cocotb test calls :func:`serve_commands`. The commands come over the socket
that ``SPLATLINE_SOCKET`` names, as tuples of a method's name and its arguments. Simulated time
stands still between commands.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from splatline.sim.cosim import simulator
from splatline.sim.cosim.simulator import Build, SimulationError

__all__ = ["ServedSimulator", "connect", "serve_commands"]

START_SECONDS = 120.0
"""Longest time that a simulator may take to start, on a busy machine."""

_SERVE = "import sys; from splatline.sim.cosim.served import run_job; run_job(sys.argv[1])"


class ServedSimulator:
    """A running simulator; use it in a ``with``, or call :meth:`close`.

    Parameters
    ----------
    built
        Result of :func:`splatline.sim.cosim.simulator.build`.
    module
        Name of the module with the cocotb test.
    plusargs
        Arguments for the Verilog, such as ``+fault=1``.
    environment
        Environment variables of the simulator.

    Raises
    ------
    SimulationError
        If it cannot be started; raised by :meth:`command` if it stops.
    """

    def __init__(
        self,
        built: Build,
        module: str,
        *,
        plusargs: Sequence[str] = (),
        environment: Mapping[str, str] | None = None,
    ) -> None:
        with contextlib.ExitStack() as stack:
            scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="splatline-"))
            self._log = Path(scratch) / "log"
            place = str(Path(scratch) / "socket")
            job = {
                "folder": str(built.folder),
                "top": built.top,
                "simulator": built.simulator,
                "module": module,
                "plusargs": list(plusargs),
                "environment": {**(environment or {}), "SPLATLINE_SOCKET": place},
            }
            self._process, self._line = self._start(stack, place, job)
            self._stack = stack.pop_all()

    def command(self, name: str, *arguments: object) -> Any:
        """Call a method of the bench in the simulator; return its result."""
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

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _start(
        self, stack: contextlib.ExitStack, place: str, job: dict[str, Any]
    ) -> tuple[subprocess.Popen[bytes], Connection[Any, Any]]:
        """Start the simulator; return its process and the connection to it."""
        listener = stack.enter_context(socket.socket(socket.AF_UNIX))
        listener.bind(place)
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


def _end(process: subprocess.Popen[bytes]) -> None:
    """Wait for a process whose connection was closed; terminate it if it does not end."""
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.terminate()
        process.wait()


def run_job(job: str) -> None:
    """Run the simulator, in the process that a :class:`ServedSimulator` starts."""
    told = json.loads(job)
    simulator.run(
        Build(Path(told["folder"]), told["top"], told["simulator"], reused=True),
        told["module"],
        checks=False,
        plusargs=told["plusargs"],
        environment={**told["environment"], "COCOTB_LOG_LEVEL": "WARNING"},
    )


def connect() -> Connection[Any, Any]:
    """Return the connection to the process that sends commands; in the simulator."""
    with socket.socket(socket.AF_UNIX) as end:
        end.connect(os.environ["SPLATLINE_SOCKET"])
        return Connection(end.detach())


async def serve_commands(line: Connection[Any, Any], bench: Any) -> None:
    """Call a bench's methods as the commands say, until the connection closes."""
    line.send("ready")
    while True:
        try:
            name, *arguments = line.recv()
        except EOFError:
            return
        line.send(await getattr(bench, name)(*arguments))
