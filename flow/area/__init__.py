"""Yosys's counts of LUTs, flip-flops, block RAMs and multipliers, and their budgets.

It imports ``contract`` and ``flow``. Start with ``synth``.
"""
