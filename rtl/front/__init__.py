"""The stages before the window: follows the line, holds the tables, computes the colour.

It imports ``contract`` and ``rtl.layouts``. Start with ``sequencer``.
"""
