"""Mutants of the Python code: how many does a room's own tests notice?

Start with ``__main__``.
"""
