"""A test bench in plain Verilog for an engine: stimulus and expected beats in files, no Python.

It imports ``contract``, ``host`` and ``sim``. Start with ``write``; ``bench.v`` is the bench.
"""
