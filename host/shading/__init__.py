"""From normals and colours to intensities and materials.

It imports ``contract`` and ``host.cloud``. Start with ``lighting``.
"""
