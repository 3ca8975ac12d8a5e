"""The engine on buses: AXI4-Stream and AXI4-Lite, and a top with few pins.

It imports ``contract``, ``rtl.engine``, ``rtl.layouts`` and ``rtl.lib``. Start with ``axi_top``.
"""
