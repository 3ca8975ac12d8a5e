"""``splatline bench``: each benchmark is a package of its own.

It imports all rooms. Start with ``command``.
"""
