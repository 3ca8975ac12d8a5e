"""Cosimulation: cocotb drives the generated Verilog in Verilator or Icarus."""
