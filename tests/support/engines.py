"""Builds of engines that the tests of a process share, and the comparison with golden."""

from functools import cache

from splatline.contract.presets import PAPER
from splatline.sim.cosim.player import frames

__all__ = ["engine", "mismatches"]


@cache
def engine(config=PAPER, simulator_name="verilator"):
    """Return an engine's build, cached by process: not for Verilog with planted faults."""
    return frames.build_engine(config, simulator_name)


def mismatches(job, outcome):
    """Return how many pixels of a job's pictures differ from golden."""
    pairs = zip(outcome.rasters, job.pictures(), strict=True)
    return sum(picture.mismatches(expected) for picture, expected in pairs)
