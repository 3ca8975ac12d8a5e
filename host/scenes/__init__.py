"""The built-in scenes.

It imports ``contract``, ``host.cloud`` and ``host.files``. Start with ``scenes``.
"""
