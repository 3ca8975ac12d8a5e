"""Tests of a bench, each with a planted fault, within the simulator: see ``planted.find_wrong``."""

import importlib
import json
from pathlib import Path

import cocotb


def with_fault(name, test, number):
    """Return a bench's test with a fault; its number 0 is none."""

    async def run(dut):
        dut.fault.value = number
        await test.func(dut)

    return cocotb.test(name=name)(run)


BENCH, RUNS = json.loads(Path("faults.json").read_text())
for place, (name, test, number) in enumerate(RUNS):
    bench = importlib.import_module(BENCH)
    globals()[f"run_{place}"] = with_fault(name, getattr(bench, test), number)
