"""Several engines that draw one picture.

It imports ``contract``, ``rtl.engine`` and ``rtl.lib``. Start with ``chain``.
"""
