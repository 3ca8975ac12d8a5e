"""Settings for every test."""

import gc
import os

from amaranth.hdl import _nir
from hypothesis import settings

import splatline  # noqa: F401 - before numba, for which it chooses how loops run in parallel

# The first call of a compiled function takes seconds, so a deadline would say nothing.
settings.register_profile("dev", deadline=None)
# On CI the same examples every time: a change that breaks one must be the change under test.
settings.register_profile("ci", deadline=None, derandomize=True, database=None)
# Most designs of the tests run for a moment, so compiling them is what takes time.
os.environ.setdefault("SPLATLINE_QUICK_BUILD", "1")
# Where benches have assertions, which show their values within the simulator too.
os.environ.setdefault(
    "COCOTB_REWRITE_ASSERTION_FILES",
    "test_*.py *slide*.py elements.py lane_frames.py pictures.py rom_words.py streams.py",
)
# A design is a million objects that live until its Verilog is written: to look for garbage among
# them after every 700 takes a fifth of the time.
gc.set_threshold(100_000, 50, 100)


def _value(cls, nets=()):
    return tuple.__new__(cls, (nets,) if isinstance(nets, _nir.Net) else nets)


# Amaranth asserts of each net of each value that it is one: a third of the time of a large design.
_nir.Value.__new__ = _value
settings.load_profile("ci" if os.environ.get("CI") else "dev")


def pytest_terminal_summary(terminalreporter):
    """Name the engines that Yosys counted, which takes minutes; ``make test`` has eight."""
    from tests.flow.area.counted import NOTE

    reports = (
        report for name in ("passed", "failed") for report in terminalreporter.getreports(name)
    )
    properties = [pair for report in reports for pair in report.user_properties]
    engines = sorted({name for note, name in properties if note == NOTE})
    if engines:
        terminalreporter.write_line(
            f"Counted anew by Yosys, as the Verilog changed: {', '.join(engines)}. "
            "To have it noted: .venv/bin/python -m tests.flow.area.counted"
        )
