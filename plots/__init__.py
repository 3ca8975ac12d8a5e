"""Figures, plots and sheets of pictures, made from results.

It imports ``contract``, ``host`` and ``sim``. Start with ``figure``.
"""
