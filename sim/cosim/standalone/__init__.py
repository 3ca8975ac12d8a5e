"""A test bench in plain Verilog for an engine: stimulus and expected beats in files, no Python.

It imports all of ``sim``, ``flow`` and ``host``. Start with ``write``; ``bench.v`` is the bench.
"""
