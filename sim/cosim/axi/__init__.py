"""Simulation of whole frames on the AXI top, through the host's driver.

It imports ``contract``, ``flow``, ``host.device`` and ``sim``. Start with ``axi_device``.
"""
