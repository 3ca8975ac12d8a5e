"""``splatline bench engine``: clock cycles of frames, beside the lower bound.

It imports all rooms. Start with ``measure``.
"""
