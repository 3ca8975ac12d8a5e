"""``splatline bench stability``: the stress suite.

It imports all rooms. Start with ``measure``.
"""
