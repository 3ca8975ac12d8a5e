"""A plugin of pytest: Verilator counts lines, branches and toggles in every run.

``$SPLATLINE_COUNTS`` names the folder that the counts are folded into. Builds with planted faults
have no counters.
"""

import os
import uuid
from pathlib import Path

from splatline.sim.cosim import served, simulator
from tests.coverage.counts import fold

OPTIONS = ["--coverage-line", "--coverage-toggle", "--coverage-max-width", "4096"]


def pytest_configure(config):
    """Count in this process, and in those that serve a simulator."""
    count()
    served._SERVE = f"from tests.coverage import collect; collect.count(); {served._SERVE}"


def count():
    """Put the counters into each build, and fold the counts of each run."""
    folder = Path(os.environ["SPLATLINE_COUNTS"]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    build, run = simulator.build, simulator.run

    def counting_build(sources, *arguments, options=(), **rest):
        is_whole = not any("planted" in text for text in sources.values())
        if is_whole and rest.get("simulator", "verilator") == "verilator":
            options = [*options, *OPTIONS]
        return build(sources, *arguments, options=options, **rest)

    def counting_run(built, *arguments, plusargs=(), **rest):
        counts = folder / f"{uuid.uuid4().hex}.dat"
        try:
            run(
                built,
                *arguments,
                plusargs=[*plusargs, f"+verilator+coverage+file+{counts}"],
                **rest,
            )
        finally:
            if counts.exists():
                fold(counts, built.folder)

    simulator.build, simulator.run = counting_build, counting_run
