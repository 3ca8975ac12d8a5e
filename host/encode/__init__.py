"""From projected splats to code words sorted by line.

It imports ``contract``, ``host.visibility``, ``host.shading`` and ``host.compiled_cache``. Start
with ``encode``.
"""
