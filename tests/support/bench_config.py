"""Which preset a bench tests: it runs inside a simulator, and the environment tells it."""

import os
from pathlib import Path
from unittest import mock

from splatline.contract.presets import PAPER, PRESETS
from splatline.contract.variants import ALL_OF_EIGHT, BANKS16, VARIANTS
from splatline.sim.cosim import blocks, simulator

__all__ = ["CONFIG", "OTHERS", "SINGLE", "run_bench", "run_built"]

VARIABLE = "SPLATLINE_TEST_PRESET"

SINGLE = BANKS16.replace(name="single-word8", raster_words=1)
"""Words of eight pixels that leave one by one, for benches of parts."""

CONFIG = {config.name: config for config in (*PRESETS.values(), *VARIANTS, *ALL_OF_EIGHT, SINGLE)}[
    os.environ.get(VARIABLE, PAPER.name)
]
"""The engine of this process: ``paper`` unless ``run_bench`` started it."""

OTHERS = [config for config in PRESETS.values() if config is not PAPER]


def run_bench(config, component, bench, **options):
    """Run a file's cocotb tests on a preset's component, in the simulator that is quicker.

    That is Icarus, which builds in no time, but for a whole window of banks: that takes it twice as
    long to run as Verilator takes for both.
    """
    from splatline.rtl.window import Window  # not above, which every bench imports

    small = component is not Window and simulator.available("icarus")
    options = {"simulator_name": "icarus" if small else "verilator", **options}
    with mock.patch.dict(os.environ, {VARIABLE: config.name}):
        blocks.run_bench(component(config), bench, **options)


def run_built(config, built, bench, test, fault):
    """Run one of a file's cocotb tests on a build of several faults: see ``faults.switched``."""
    with mock.patch.dict(os.environ, {VARIABLE: config.name}):
        simulator.run(
            built,
            Path(bench),
            test=test,
            plusargs=[f"+fault={fault}"],
        )
