"""Mutants of the generated Verilog, and how many of them the tests notice: ``make mutants``.

It imports everything. Start with ``judge``; ``docs/mutants.md`` says what is measured.
"""
