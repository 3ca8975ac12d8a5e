"""``splatline bench host``: run time of host and golden.

It imports all rooms. Start with ``measure``.
"""
