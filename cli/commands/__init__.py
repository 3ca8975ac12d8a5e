"""One file a command, or two that belong together.

It imports all rooms. Start with ``render``.
"""
