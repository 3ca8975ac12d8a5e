"""Cycle models, equal to the Verilog to the cycle, and the fewest cycles possible.

It imports ``contract``, ``host`` and ``sim.golden``. Start with ``cycles``.
"""
