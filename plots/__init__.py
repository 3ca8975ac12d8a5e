"""Figures, plots and sheets of pictures, made from results.

It imports ``contract`` and ``sim``. Start with ``figure``.
"""
