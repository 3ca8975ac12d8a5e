"""Simulation of whole frames: a player in Verilog that feeds the engine, and its control.

It imports ``contract``, ``rtl.chain``, ``flow``, ``host.encode`` and ``sim``. Start with
``frames``.
"""
