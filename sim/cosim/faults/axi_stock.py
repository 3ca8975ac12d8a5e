"""Frames and tables for the AXI top, whose table writes are accesses of the register bus."""

from __future__ import annotations

import functools
from typing import Any

from splatline.contract.config import EngineConfig
from splatline.contract.register_map import register_map

from .stock import Stock

__all__ = ["READ", "AxiStock", "access"]

WHOLE, READ = 15, 16
"""Of ``Write::kind`` in ``ports_axi.h``: all four bytes of a write; a read."""


def access(offset: int, value: int = 0, kind: int = WHOLE, at: int = 0) -> tuple[Any, ...]:
    """Return an access of the bus as a record ``WRITE``, offered from a cycle on."""
    return (at, (offset | value << 32, 0), kind)


class AxiStock(Stock):
    """A :class:`Stock` for the AXI top; its parameters are those."""

    def __init__(self, config: EngineConfig, seed: int) -> None:
        super().__init__(config, seed)
        self.map = register_map(config)

    def write(self, register: str, value: int, at: int = 0) -> tuple[Any, ...]:
        """Return the write of a register."""
        return access(self.map[register].offset, value, at=at)

    def read(self, register: str, at: int = 0) -> tuple[Any, ...]:
        """Return the read of a register."""
        return access(self.map[register].offset, kind=READ, at=at)

    def setup(self, size: tuple[int, int], *, load: bool = False) -> list[tuple[Any, ...]]:
        """Return the writes of all frame registers."""
        values = {
            **{f"AMBIENT_{c}": int(i) for c, i in zip(CHANNELS, self.tables.ambient, strict=True)},
            "LAST_COLUMN": size[0] - 1,
            "LAST_LINE": size[1] - 1,
            "START": int(load),
        }
        return [self.write(name, value) for name, value in values.items()]

    @functools.cached_property
    def materials(self) -> list[tuple[Any, ...]]:
        """The writes of all materials, lowest word first."""
        window, mask = self.map.materials, (1 << self.config.table_data.width) - 1
        entries = [super(AxiStock, self).material(index) for index in range(window.entries)]
        data = [(low | high << 64) & mask for _, (low, high), _ in entries]
        return [
            access(window.offset + entry * window.stride + 4 * word, value >> 32 * word & FULL)
            for entry, value in enumerate(data)
            for word in range(window.words)
        ]


CHANNELS = ("RED", "GREEN", "BLUE")
FULL = 0xFFFF_FFFF
