"""``splatline bench configurations``: comparison of windows, widths and depths.

It imports all rooms. Start with ``measure``.
"""
