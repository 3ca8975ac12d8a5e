"""A driver in freestanding C99, for whoever has no Python beside the engine.

``splatline registers --c-driver FOLDER`` writes it, with the header of a preset's registers. It
imports nothing. Start with ``splatline_driver``.
"""

from pathlib import Path

__all__ = ["DRIVER"]

FILES = ("splatline_driver.h", "splatline_driver.c")
DRIVER = tuple(Path(__file__).with_name(name) for name in FILES)
"""The folder of the driver's files."""
