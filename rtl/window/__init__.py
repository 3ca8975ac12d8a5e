"""Parts of both windows: loader, frame overlap, and what their services and flush scans share.

It imports ``contract`` and ``rtl.layouts``. Start with ``loader``.
"""
