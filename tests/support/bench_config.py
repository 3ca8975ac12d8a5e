"""The preset of a bench. The bench runs in a simulator and gets it from the environment."""

import os
from unittest import mock

from splatline.contract.config import EngineConfig
from splatline.contract.presets import PAPER, PRESETS
from splatline.contract.variants import NARROW_BLOCKS, VARIANTS
from splatline.sim.cosim import blocks, simulator

__all__ = ["CONFIG", "OTHERS", "PAIRED", "run_bench", "run_built"]

VARIABLE = "SPLATLINE_TEST_PRESET"


class Paired(EngineConfig):
    """An engine whose lanes flush pairs of words, with any pixels a word."""

    flush_words = 2


PAIRED = Paired(name="paired")
"""``paper`` with lanes that flush pairs of words, as those of ``lanes8``, for the same benches."""

CONFIG = {config.name: config for config in (*PRESETS.values(), *VARIANTS, NARROW_BLOCKS, PAIRED)}[
    os.environ.get(VARIABLE, PAPER.name)
]
"""The engine of this process: ``paper`` unless ``run_bench`` started it."""

OTHERS = [config for config in PRESETS.values() if config is not PAPER]


def run_bench(config, component, bench, **options):
    """Run a file's cocotb tests on a preset's component.

    The simulator is Icarus, which builds faster, or Verilator if Icarus is not installed.
    """
    quicker = "icarus" if simulator.available("icarus") else "verilator"
    options = {"simulator_name": quicker, **options}
    with mock.patch.dict(os.environ, {VARIABLE: config.name}):
        blocks.run_bench(component(config), bench, **options)


def run_built(config, built, modules, folder):
    """Run the cocotb tests of modules, whose names have commas between, on a preset's build."""
    with mock.patch.dict(os.environ, {VARIABLE: config.name}):
        simulator.run(built, modules, folder=folder)
