"""``splatline bench accuracy``: error against run time.

It imports all rooms. Start with ``measure``.
"""
