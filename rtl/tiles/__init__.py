"""The small window: sixteen lanes or so draw a tile of four lines a cycle.

It imports ``contract``, ``rtl.layouts``, ``rtl.window``, ``rtl.shapes`` and ``rtl.lib``. Start with
``window``.
"""
