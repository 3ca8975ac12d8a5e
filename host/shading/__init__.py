"""From normals and colours to intensities and materials.

It imports ``contract``, ``host.cloud`` and ``host.compiled_cache``. Start with ``lighting``.
"""
