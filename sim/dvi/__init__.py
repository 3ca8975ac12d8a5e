"""A DVI receiver: from bits on the pins to the pictures on the screen.

It imports nothing of ours, and shares nothing with the transmitter. Start with ``receiver``.
"""
