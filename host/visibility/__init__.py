"""What a view shows: projection, culling, occlusion, and an index of blocks of points.

It imports ``contract``, ``host.cloud``, ``host.shading`` and ``host.compiled_cache``. Start with
``view``.
"""
