"""Whole frames through the Verilog: a player in Verilog, and its control.

It imports ``contract``, ``flow`` and ``sim``. Start with ``frames``.
"""
