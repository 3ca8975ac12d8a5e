"""From projected splats to code words sorted by line.

It imports ``contract``, ``host.visibility``, ``host.shading``, ``host.compiled_cache`` and
``host.deal``. Start with ``encode``.
"""
