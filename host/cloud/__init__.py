"""The cloud, and what is estimated from it: normals and splat radii.

It imports ``contract``. Start with ``cloud``.
"""
