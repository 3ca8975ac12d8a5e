"""The shape ROM: turns compact words into code words, and its contents.

It imports ``contract`` and ``rtl.layouts``. Start with ``rom``.
"""
