"""The pin-level top as a netlist of Virtex-II's cells, for the vendor's last tools."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from .format import PAPER, EngineConfig
from .pins import generate_pins
from .synth import COMMAND, RUN_YOSYS

__all__ = ["pin_netlist", "run_tool"]

WRITE_EDIF = "write_edif -pvector bra"


def pin_netlist(config: EngineConfig = PAPER, name: str = "splatline") -> tuple[str, dict]:
    """Return an engine with its pins as EDIF, and as Yosys' JSON of the same cells.

    ``-ise`` makes what ISE reads, buffers at the pins and a global one for the clock among it. The
    commands are those by which resources are counted, so the netlist is what the counts are of.

    Parameters
    ----------
    config
        The engine's configuration.
    name
        Name of the top module.

    Returns
    -------
    edif
        EDIF 2 0 0, buses in square brackets.
    module
        The flat top module.

    Raises
    ------
    RuntimeError
        If Yosys fails.
    """
    text, _ = generate_pins(config, name)
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(text)
        script = (
            f"read_verilog top.v; {COMMAND} -flatten -top {name}; "
            f"{WRITE_EDIF} top.edif; write_json top.json"
        )
        run_tool("Yosys", RUN_YOSYS, ["-q", "-p", script], folder)
        module = json.loads((folder / "top.json").read_text())["modules"][name]
        return (folder / "top.edif").read_text(), module


def run_tool(tool: str, program: str, arguments: list[str], folder: Path) -> str:
    """Run a Python program in a folder and return its log, or raise ``RuntimeError`` with it."""
    done = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"{tool} failed:\n{done.stdout[-2000:]}")
    return done.stdout
