"""Pictures larger than an engine's image, as frames of tiles.

It imports ``contract`` and ``host``. Start with ``frames``.
"""
