"""From projected splats to code words sorted by line.

It imports ``contract``, ``host.visibility`` and ``host.shading``. Start with ``encode``.
"""
