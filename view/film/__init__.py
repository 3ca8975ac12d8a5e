"""Films: a cloud, a way of the camera and settings in, an MP4, a GIF or a WebP out.

It imports ``contract``, ``host`` and ``view``. Start with ``film``.
"""
