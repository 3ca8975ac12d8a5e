"""The built-in scenes.

It imports ``contract`` and ``host.cloud``. Start with ``scenes``.
"""
