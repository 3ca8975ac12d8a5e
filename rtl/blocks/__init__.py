"""The fast window: eight rows of lanes draw a whole element a cycle.

The rows are the paper's eight parallel line writers, one for each line modulo 8. It imports
``contract``, ``rtl.layouts``, ``rtl.window``, ``rtl.shapes`` and ``rtl.lib``. Start with
``window``.
"""
