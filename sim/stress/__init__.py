"""The stress suite: inputs that are numerically hard for the renderer.

It imports ``contract``, ``host`` and ``sim``. Start with ``case``.
"""
