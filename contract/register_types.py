"""The parts of a register map, in plain Python: registers, fields and the material table.

The map of the engine is :mod:`splatline.contract.register_map`. This file imports no Amaranth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

from .config import EngineConfig
from .fields import Field

__all__ = [
    "REGISTER_BYTES",
    "Access",
    "BusField",
    "BusRegister",
    "MaterialWindow",
    "RegisterMap",
]

REGISTER_BYTES = 0x80
"""Registers lie below this offset, a power of two."""


class Access(Enum):
    """The accesses that a field allows."""

    READ_ONLY = "ro"
    READ_WRITE = "rw"
    CLEAR = "w1c"
    WRITE_ONLY = "wo"

    @property
    def readable(self) -> bool:
        """A read gives its value."""
        return self is not Access.WRITE_ONLY

    @property
    def writable(self) -> bool:
        """A write may set its bits."""
        return self is not Access.READ_ONLY


@dataclass(frozen=True)
class BusField:
    """A run of bits of a register.

    Parameters
    ----------
    name
        In capitals.
    place
        Its bits.
    access
        ``rw`` keeps what is written; ``w1c`` is set by the hardware and cleared by a 1; a 1 to a
        ``wo`` bit does something once.
    meaning
        One phrase.
    reset
        Value after reset, or the value of a constant.
    live
        Whether a ``ro`` field follows the hardware; else it is a constant.
    """

    name: str
    place: Field
    access: Access
    meaning: str
    reset: int = 0
    live: bool = False

    @property
    def mask(self) -> int:
        """Its bits of the register."""
        return self.place.mask << self.place.lsb


@dataclass(frozen=True)
class BusRegister:
    """32 bits at an address.

    Parameters
    ----------
    name
        In capitals.
    offset
        Bytes from the start of the map.
    meaning
        One phrase.
    fields
        The lowest first.
    between_frames
        A write is refused while a frame is open.
    table
        Address of the engine's table write (``docs/contract.md``) that a write becomes.
    """

    name: str
    offset: int
    meaning: str
    fields: tuple[BusField, ...]
    between_frames: bool = False
    table: int | None = None

    @property
    def readable(self) -> bool:
        """A read gives something."""
        return any(field.access.readable for field in self.fields)

    @property
    def writable(self) -> int:
        """The bits that a write may set; 0: no write is taken."""
        return sum(field.mask for field in self.fields if field.access.writable)

    @property
    def accepted(self) -> int:
        """The bits that a write may have set; another one makes the bus refuse the write.

        A register with ``w1c`` fields ignores all other bits, so that a driver can write back what
        it read.
        """
        clears = any(field.access is Access.CLEAR for field in self.fields)
        return (1 << 32) - 1 if clears else self.writable

    def __getitem__(self, name: str) -> BusField:
        """Return a field by name."""
        return next(field for field in self.fields if field.name == name)


@dataclass(frozen=True)
class MaterialWindow:
    """The material table: an entry is a few consecutive words, and the last word writes it.

    Parameters
    ----------
    offset
        Bytes from the start of the map to entry 0.
    entries
        Entries of the table.
    words
        Words of an entry that are written, the lowest first.
    stride
        Bytes from an entry to the next.
    fields
        Bits of an entry, which may cross from a word into the next.
    """

    offset: int
    entries: int
    words: int
    stride: int
    fields: tuple[BusField, ...]

    @property
    def bits(self) -> int:
        """Bits of an entry."""
        return max(field.place.end for field in self.fields)

    @property
    def writable(self) -> tuple[int, ...]:
        """The bits that a write may set, of each word."""
        mask = (1 << self.bits) - 1
        return tuple(mask >> 32 * word & 0xFFFF_FFFF for word in range(self.words))


@dataclass(frozen=True)
class RegisterMap:
    """The registers of an engine on its AXI4-Lite port.

    Parameters
    ----------
    config
        The engine's configuration.
    registers
        In the order of their offsets.
    materials
        The material table.

    Raises
    ------
    ValueError
        If a register lies too far up.
    """

    config: EngineConfig
    registers: tuple[BusRegister, ...]
    materials: MaterialWindow

    def __post_init__(self) -> None:
        """Check the offsets, on which the address decoder relies."""
        last = max(register.offset for register in self.registers)
        if last >= REGISTER_BYTES:
            raise ValueError(f"a register at {last:#x}: they must lie below {REGISTER_BYTES:#x}")

    @property
    def address_bits(self) -> int:
        """Bits of an address on the bus: the materials take the upper half at most."""
        return self.materials.offset.bit_length()

    def __getitem__(self, name: str) -> BusRegister:
        """Return a register by name."""
        return next(register for register in self.registers if register.name == name)

    def fields(self) -> Iterator[tuple[str, BusRegister, BusField]]:
        """Yield every field with a name of its own, such as ``control_hold``."""
        for register in self.registers:
            for field in register.fields:
                yield f"{register.name}_{field.name}".lower(), register, field
