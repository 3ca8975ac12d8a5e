"""``splatline bench surface``: pictures of sampled scenes against their true surfaces.

It imports all rooms. Start with ``command``.
"""
