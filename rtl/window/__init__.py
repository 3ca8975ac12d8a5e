"""Parts of both windows: the loader of an initial raster, and frame overlap.

It imports ``contract`` and ``rtl.layouts``. Start with ``loader``.
"""
