"""Yosys's counts of LUTs, flip-flops, block RAMs and multipliers, and their budgets.

It imports ``contract``, ``rtl`` and ``flow``. Start with ``synth``.
"""
