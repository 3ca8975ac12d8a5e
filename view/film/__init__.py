"""Films: a cloud, a way of the camera and settings in, an MP4, a GIF or a WebP out.

It imports what ``view`` does. Start with ``film``.
"""
