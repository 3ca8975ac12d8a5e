"""Drivers: one interface for a board and for a simulation.

It imports ``contract``. Start with ``driver``.
"""
