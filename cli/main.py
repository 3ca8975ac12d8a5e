"""The program ``splatline``: its commands, error messages and exit codes."""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import click

from splatline.cli.lazy_group import LazyGroup
from splatline.cli.options.address_space import check_address_space
from splatline.contract.errors import InputError
from splatline.contract.tool_error import ToolFailure
from splatline.flow.tools import ToolError

__all__ = ["main"]

BAD_INPUT = 2
"""Exit code of bad input and of a wrong command line."""

TOOL_FAILED = 1
"""Exit code if Yosys, nextpnr or ecppack failed."""

NO_MEMORY = (
    "the cloud does not fit the memory; close other programs, or write it as LAS, LAZ or binary"
    " PLY, which --memory reads in parts"
)
"""Message of a MemoryError."""

NOT_LOADED = "failed to map segment", "annot allocate memory", "cannot create shared object"
"""The message of glibc's loader for a library that does not fit the memory."""

INTERRUPTED = 130
"""Exit code of a run stopped with Ctrl-C, by the convention of shells (128 + SIGINT)."""

TERMINATED = 143
"""Exit code of a run stopped with SIGTERM (128 + SIGTERM)."""


class Program(LazyGroup):
    """Group of commands that reports a user's error in one line, without a traceback."""

    def main(  # type: ignore[override]  # click overloads it by standalone_mode
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        *,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run a command and exit with its code; see ``click.Command.main``."""
        if not standalone_mode:
            return super().main(args, prog_name, standalone_mode=False, **extra)
        _print_any_name()
        try:
            with _exits_on_sigterm():
                code = super().main(args, prog_name, standalone_mode=False, **extra)
        except click.exceptions.NoArgsIsHelpError as error:
            error.show()
            code = BAD_INPUT
        except ToolFailure as error:  # the message keeps its lines, which hold the tool's log
            click.echo(f"splatline: {error.format_message()}", err=True)
            code = error.exit_code
        except ToolError as error:  # the same
            click.echo(f"splatline: {error}", err=True)
            code = TOOL_FAILED
        except click.ClickException as error:
            code = _complain(_usage(error))
        except InputError as error:
            code = _complain(str(error))
        except OSError as error:
            code = _complain(_file_trouble(error))
        except MemoryError:
            code = _complain(NO_MEMORY)
        except ImportError as error:
            if not any(words in str(error) for words in NOT_LOADED):
                raise
            code = _complain(NO_MEMORY)
        except click.Abort:  # click raises it on Ctrl-C
            code = INTERRUPTED
        sys.exit(code)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that is run; see ``click.Group.resolve_command``."""
        if args[0] in DRAWING:  # before its module loads a library
            check_address_space()
        return super().resolve_command(ctx, args)


def _print_any_name() -> None:
    """Let names that the terminal's encoding lacks be printed with escapes, not as an error."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def _exits_on_sigterm() -> Iterator[None]:
    """Exit on SIGTERM as on Ctrl-C, so that tools are killed and scratch files are removed."""

    def end(*_: object) -> None:
        sys.exit(TERMINATED)

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _complain(message: str) -> int:
    """Print an error message as one line on standard error; return the exit code."""
    click.echo(f"splatline: {' '.join(message.split())}", err=True)
    return BAD_INPUT


def _usage(error: click.ClickException) -> str:
    """Return click's message, followed by the command that shows the help."""
    message = error.format_message()
    if isinstance(error, click.UsageError) and error.ctx is not None:
        return f"{message.rstrip('.')} (see {error.ctx.command_path} --help)"
    return message


def _file_trouble(error: OSError) -> str:
    """Return the system's message with the name of the file."""
    reason = error.strerror or str(error) or type(error).__name__
    return reason if error.filename is None else f"{os.fspath(error.filename)}: {reason}"


COMMANDS = {
    "bench": "splatline.cli.bench.command:bench",
    "board": "splatline.cli.commands.board:board",
    "encode": "splatline.cli.commands.encode_play:encode",
    "film": "splatline.cli.commands.film:film",
    "info": "splatline.cli.commands.info:info",
    "netlist": "splatline.cli.commands.pnr:netlist",
    "play": "splatline.cli.commands.encode_play:play",
    "pnr": "splatline.cli.commands.pnr:pnr",
    "registers": "splatline.cli.commands.registers:registers",
    "render": "splatline.cli.commands.render:render",
    "synth": "splatline.cli.commands.verilog_synth:synth",
    "verilog": "splatline.cli.commands.verilog_synth:verilog",
    "view": "splatline.cli.commands.view:view",
}

DRAWING = {"bench", "encode", "film", "info", "play", "render", "view"}
"""Commands that load numba."""


@click.group(
    cls=Program,
    lazy=COMMANDS,
    context_settings={
        "help_option_names": ["-h", "--help"],
        "max_content_width": 100,
        "show_default": True,
    },
)
@click.version_option(None, "--version", package_name="splatline", prog_name="splatline")
def main() -> None:
    """Draw point clouds with an open-source hardware engine.

    \b
    Examples:
      splatline render                          the built-in scene, drawn by the golden renderer
      splatline render scan.ply -o scan.png     a scan
      splatline view scan.laz                   turn a scan in the browser
      splatline film scan.ply -o scan.mp4       the scan turns
      splatline render --engine rtl             the same by the Verilog, checked pixel for pixel
      splatline verilog -o engine.v             the hardware
    """  # noqa: D301  (click reads the backspace as "do not wrap")
