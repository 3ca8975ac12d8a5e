"""From hardware to files and figures: Verilog, netlists, areas and clock rates.

It imports ``contract`` and ``rtl``. Start with ``verilog``.
"""
