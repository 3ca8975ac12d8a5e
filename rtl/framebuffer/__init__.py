"""The frame buffer: raster beats become a picture in memory, by bursts on AXI4.

It imports ``contract``, ``rtl.layouts``, ``rtl.lib`` and ``rtl.bus``. Start with ``frame_writer``.
"""
