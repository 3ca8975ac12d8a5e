"""Simulation of whole frames: a player in Verilog that feeds the engine, and its control.

It imports ``contract``, ``flow`` and ``sim``. Start with ``frames``.
"""
