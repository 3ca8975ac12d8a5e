"""What both kinds of window share: loading an initial raster, and frames that overlap.

It imports ``contract`` and ``rtl.layouts``. Start with ``loader``.
"""
