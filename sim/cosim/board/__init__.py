"""A board in a simulator: clocks, cells of the device, a serial link, and a recorder of HDMI pins.

It imports ``sim``, and takes the board's Verilog as text. Start with ``board_device``.
"""
