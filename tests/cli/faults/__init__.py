"""Commands whose surroundings fail: full disks, kills, little memory. ``make faults TOP=host``.

Start with ``__main__``. ``forker`` runs a command many times in processes of its own.
"""
