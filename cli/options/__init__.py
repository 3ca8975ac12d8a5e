"""Options that several commands share.

It imports all rooms. Start with ``cloud_and_view``.
"""
