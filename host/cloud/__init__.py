"""The cloud, and what is estimated from it: normals and splat radii.

It imports ``contract`` and ``host.compiled_cache``. Start with ``cloud``.
"""
