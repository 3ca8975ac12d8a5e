"""A bench that fails where pytest is loaded."""

import sys

import cocotb


@cocotb.test()
async def without_pytest(dut):
    if hasattr(sys.modules["pytest"], "fixture"):
        raise RuntimeError("pytest is loaded")
