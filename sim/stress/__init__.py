"""Inputs that are meant to break the renderer.

It imports ``contract``, ``host`` and ``sim``. Start with ``case``.
"""
