"""From points to visible splats: projection, culling, occlusion, an index of blocks of points.

It imports ``contract``, ``host.cloud``, ``host.shading`` and ``host.compiled_cache``. Start with
``view``.
"""
