"""Engines that several tests of a process play frames to, and what golden says of the pictures."""

from functools import cache

from splatline.contract.presets import PAPER
from splatline.sim.cosim.player import frames

__all__ = ["engine", "mismatches"]


@cache
def engine(config=PAPER, simulator_name="verilator"):
    """Return an engine's build. Its Verilog is made once, so a broken one is not for this."""
    return frames.build_engine(config, simulator_name)


def mismatches(job, outcome):
    """Return how many pixels of a job's pictures differ from golden's."""
    pairs = zip(outcome.rasters, job.pictures(), strict=True)
    return sum(picture.mismatches(expected) for picture, expected in pairs)
