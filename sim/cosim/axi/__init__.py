"""Whole frames through the Verilog on its buses, by the driver.

It imports ``contract``, ``flow``, ``host.device`` and ``sim``. Start with ``axi_device``.
"""
