"""Which preset a bench tests: it runs inside a simulator, and the environment tells it."""

import os
from unittest import mock

from splatline.rtl.format import PAPER, PRESETS, get_preset
from splatline.sim.cosim import blocks, simulator

__all__ = ["CONFIG", "OTHERS", "run_bench"]

VARIABLE = "SPLATLINE_TEST_PRESET"

CONFIG = get_preset(os.environ.get(VARIABLE, PAPER.name))
"""The preset of this process: ``paper`` unless ``run_bench`` started it."""

OTHERS = [config for config in PRESETS.values() if config is not PAPER]


def run_bench(config, component, bench, **options):
    """Run a file's cocotb tests on a preset's component, in the simulator that builds faster."""
    quickest = "icarus" if simulator.available("icarus") else "verilator"
    with mock.patch.dict(os.environ, {VARIABLE: config.name}):
        blocks.run_bench(component(config), bench, **{"simulator_name": quickest, **options})
