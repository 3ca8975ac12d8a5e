"""The narrow top as a netlist of Virtex-II cells, for ISE."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from pathlib import Path

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.flow.area.synth import COMMAND

from .narrow_verilog import generate_pins
from .tools import run_yosys

__all__ = ["pin_netlist"]

WRITE_EDIF = "write_edif -pvector bra"


def pin_netlist(
    config: EngineConfig = PAPER,
    name: str = "splatline",
    progress: Callable[[float], None] | None = None,
) -> tuple[str, dict]:
    """Return the narrow top as EDIF, and the same netlist as Yosys' JSON.

    The option ``-ise`` makes a netlist for ISE, with I/O buffers and a global clock buffer. The
    commands are those of :func:`splatline.flow.area.synth.synthesise`, so its counts are of this
    netlist.

    Parameters
    ----------
    config
        The engine's configuration.
    name
        Name of the top module.
    progress
        Called with the share of the synthesis that is done.

    Returns
    -------
    edif
        EDIF 2 0 0, buses in square brackets.
    module
        The flat top module.

    Raises
    ------
    ToolError
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
        run_yosys(script, folder, progress)
        module = json.loads((folder / "top.json").read_text())["modules"][name]
        return (folder / "top.edif").read_text(), module
