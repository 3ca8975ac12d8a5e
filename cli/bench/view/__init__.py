"""``splatline bench view``: frames a second and latency of the live view, over a real WebSocket.

It imports all rooms. Start with ``command``.
"""
