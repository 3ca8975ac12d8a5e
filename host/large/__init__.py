"""Clouds larger than the memory: thinned, while they are read, to what a view can show.

It imports ``contract`` and ``host``. Start with ``thin``.
"""
