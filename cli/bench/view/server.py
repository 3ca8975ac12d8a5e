"""A live view in a process of its own."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from splatline.cli.bench.host.first_picture import OURS
from splatline.contract.tool_error import ToolFailure

__all__ = ["Server", "running_view"]

PATIENCE = 120.0
"""Seconds that a process has to start or to end."""


class Server:
    """A process that serves a live view.

    Parameters
    ----------
    process
        The process.
    address
        What it printed.
    """

    def __init__(self, process: subprocess.Popen[str], address: str) -> None:
        self.process = process
        self.address = address

    def processor_seconds(self) -> float | None:
        """Return the processor time that the process took so far; None where /proc is missing."""
        try:
            text = Path(f"/proc/{self.process.pid}/stat").read_text()
        except OSError:
            return None
        user, system = text.rpartition(")")[2].split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


@contextmanager
def running_view(arguments: Sequence[str]) -> Iterator[Server]:
    """Start ``splatline view`` with some arguments, and end it by Ctrl-C.

    Raises
    ------
    ToolFailure
        If it does not start, or does not end with exit code 0.
    """
    command = [sys.executable, "-c", OURS, "view", *arguments, "--no-browser"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        try:
            yield Server(process, _address(process))
        except BaseException:
            process.kill()
            raise
        process.send_signal(signal.SIGINT)
        try:
            code = process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            raise ToolFailure("`splatline view` did not end on Ctrl-C") from None
        if code:
            raise ToolFailure(f"`splatline view` ended with exit code {code}")


def _address(process: subprocess.Popen[str]) -> str:
    """Return the address that the process prints."""
    assert process.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and process.poll() is None:
            if selector.select(1.0):
                line = process.stdout.readline()
                if line.startswith("http"):
                    return line.strip()
    raise ToolFailure("`splatline view` did not print its address")
