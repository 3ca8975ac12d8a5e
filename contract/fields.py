"""Runs of bits of a word, and the numbers of the frame registers."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Field", "Register"]


@dataclass(frozen=True)
class Field:
    """A run of bits: ``(word >> lsb) & mask``."""

    lsb: int
    width: int

    @property
    def mask(self) -> int:
        """Largest value that the field holds."""
        return (1 << self.width) - 1

    @property
    def end(self) -> int:
        """First bit above the field."""
        return self.lsb + self.width


class Register:
    """Offsets of the frame registers, counted from ``EngineConfig.register_base``."""

    AMBIENT_RED = 0
    AMBIENT_GREEN = 1
    AMBIENT_BLUE = 2
    LAST_COLUMN = 3
    LAST_LINE = 4
    CONTROL = 5

    CONTROL_LOAD = 0
    """Bit of CONTROL: the frame starts from the raster on the ``initial`` port."""
