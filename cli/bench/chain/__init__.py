"""``splatline bench chain``: chains of engines.

It imports all rooms. Start with ``measure``.
"""
