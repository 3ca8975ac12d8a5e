"""The live view's server: pages, a WebSocket for each tab, and threads that draw.

It imports the rest of ``view`` and aiohttp, which the extra ``view`` installs. Start with
``protocol``, then ``run``.
"""
