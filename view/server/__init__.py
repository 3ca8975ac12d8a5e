"""The live view's server: pages, a WebSocket for each tab, and threads that draw.

It imports ``contract``, ``host``, ``view`` and aiohttp, which the extra ``view`` installs. Start
with ``protocol``, then ``run``.
"""
