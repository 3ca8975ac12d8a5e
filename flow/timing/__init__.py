"""Clock rates: routed on an ECP5, and estimated for the Virtex-II.

It imports ``contract`` and ``flow``. Start with ``pnr``.
"""
