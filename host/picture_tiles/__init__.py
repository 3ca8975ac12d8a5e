"""Pictures larger than an engine's image, as frames of tiles.

It imports the rest of the host. Start with ``frames``.
"""
