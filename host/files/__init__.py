"""Readers: from a file to columns of numbers, and from those to a cloud.

It imports ``contract`` and ``host.cloud``. Start with ``readers``.
"""
