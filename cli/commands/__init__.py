"""Commands: each file has one, or a few that belong together.

It imports all rooms. Start with ``render``.
"""
