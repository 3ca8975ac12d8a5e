"""Faults from outside: streams, stalls, resets, table writes and upsets, by the hundred thousand.

It imports ``contract``, ``flow``, ``host`` and ``sim``. Start with ``campaign``.
"""
