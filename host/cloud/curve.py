"""Morton's curve: the bits of three coordinates in turn, for compiled code."""

from __future__ import annotations

import numba as nb

__all__ = ["common_levels", "joined_bits", "spread_bits"]


@nb.njit(inline="always")
def spread_bits(cell: int) -> int:
    """Return 21 bits with two zeros between each and the next."""
    cell = (cell | cell << 32) & 0x001F00000000FFFF
    cell = (cell | cell << 16) & 0x001F0000FF0000FF
    cell = (cell | cell << 8) & 0x100F00F00F00F00F
    cell = (cell | cell << 4) & 0x10C30C30C30C30C3
    return (cell | cell << 2) & 0x1249249249249249


@nb.njit(inline="always")
def joined_bits(key: int) -> int:
    """Return every third bit: the inverse of ``spread_bits``."""
    key = key & 0x1249249249249249
    key = (key | key >> 2) & 0x10C30C30C30C30C3
    key = (key | key >> 4) & 0x100F00F00F00F00F
    key = (key | key >> 8) & 0x001F0000FF0000FF
    key = (key | key >> 16) & 0x001F00000000FFFF
    return (key | key >> 32) & 0x1FFFFF


@nb.njit(inline="always")
def common_levels(difference: int, levels: int) -> int:
    """Return the deepest level at which two points share a cube, from their keys' difference."""
    while difference:
        difference >>= 3
        levels -= 1
    return levels
