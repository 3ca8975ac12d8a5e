"""What a view shows: projection, culling, occlusion, and an index of blocks of points.

It imports ``contract`` and ``host.cloud``. Start with ``view``.
"""
