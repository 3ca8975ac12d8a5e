"""From points to visible splats: projection, culling, occlusion, an index of blocks of points.

It imports ``contract``, ``host.cloud``, ``host.shading``, ``host.compiled_cache`` and
``host.deal``. Start with ``view``.
"""
