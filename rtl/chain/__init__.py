"""Several engines that draw one picture.

It imports ``contract``, ``rtl.engine``, ``rtl.layouts`` and ``rtl.lib``. Start with ``chain``.
"""
