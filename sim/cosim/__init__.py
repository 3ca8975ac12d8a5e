"""Cosimulation: cocotb drives the generated Verilog in Verilator or Icarus.

It imports ``contract``, ``rtl``, ``flow``, ``host`` and ``sim``; cocotb is an extra. Start with
``simulator``.
"""
