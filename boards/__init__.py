"""Whole systems on boards that people own: memory, link, engine and screen, with LiteX.

It imports ``contract``, ``flow`` and ``host``; only ``cli`` imports it. Start with
``soc``. What builds hardware needs the extra ``board``; what drives a board does not.
"""
