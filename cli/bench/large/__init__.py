"""``splatline bench large``: clouds larger than the memory.

It imports all rooms. Start with ``command``.
"""
