"""Engines that several tests of a process play frames to."""

from functools import cache

from splatline.rtl.format import PAPER
from splatline.sim.cosim import frames

__all__ = ["engine"]


@cache
def engine(config=PAPER, simulator_name="verilator"):
    """Return an engine's build. Its Verilog is made once, so a broken one is not for this."""
    return frames.build_engine(config, simulator_name)
