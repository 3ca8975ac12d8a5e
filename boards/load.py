"""Loads a bitstream into a board, with openFPGALoader."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from splatline.contract.errors import InputError
from splatline.flow.tools import ToolError

from .catalog import BOARDS

__all__ = ["load_bitstream"]

LOADER = "openFPGALoader"


def load_bitstream(name: str, bitstream: Path) -> None:
    """Load a bitstream into the FPGA's configuration memory, until power is off.

    Raises
    ------
    InputError
        If openFPGALoader is not installed, or there is no such file.
    ToolError
        If it fails, with its last line.
    """
    if not bitstream.is_file():
        raise InputError(f"there is no file {bitstream}; make it: splatline board build {name}")
    program = shutil.which(LOADER)
    if program is None:
        raise InputError(f"{LOADER} is not installed: apt-get install openfpgaloader")
    done = subprocess.run(
        [program, "-b", BOARDS[name].loader, str(bitstream)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        lines = done.stdout.strip().splitlines() or ["no message"]
        raise ToolError(f"{LOADER} failed: {lines[-1]}")
