"""``splatline bench``: one package a benchmark.

It imports all rooms. Start with ``command``.
"""
