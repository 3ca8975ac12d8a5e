"""What the shape ROM's two memories hold: the table folded, and each shape written down once."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from .format import BLOCK, ROWS, EngineConfig
from .shape_table import EMPTY, FOLDED, folded_shapes

__all__ = ["SMALLEST", "TINY", "ShapeContents", "shape_contents"]

SMALLEST = 4
"""Sizes below it share a row of numbers, as all of them together have few shapes."""

TINY = 3
"""Bits of a number of theirs."""

FRACTIONS = 4
"""Rows of numbers of a size over 8: one for each fraction of its upper half."""


@dataclass(frozen=True)
class ShapeContents:
    """The initial contents of both memories.

    Parameters
    ----------
    numbers
        By row (see ``_row_of``), then by n'x and n'y as in ``folded_shapes``: the place of a shape
        in ``shapes``. In the last row three numbers of ``TINY`` bits stand side by side, of the
        sizes 0 and 1 (which are the same), 2 and 3.
    shapes
        SCANS, and above them a bit for each row that is empty. Place 0 has no shape: it is all 0.
    """

    numbers: list[int]
    shapes: list[int]

    @property
    def number_bits(self) -> int:
        """Bits of a place in ``shapes``."""
        return (len(self.shapes) - 1).bit_length()

    @property
    def shape_bits(self) -> int:
        """Bits of an entry of ``shapes``."""
        return 7 * ROWS


def _row_of(size: int, fraction: int, config: EngineConfig) -> int:
    """Return in which row a size's numbers stand.

    Sizes over 8 come first, by the three lowest bits of the size (16 before 9) and the fraction;
    then those of 4 to 8, and the row of the others. So a few gates find it.
    """
    large = BLOCK * FRACTIONS if config.largest_shape > BLOCK else 0
    if size > BLOCK:
        return FRACTIONS * (size % BLOCK) + fraction
    return large + (5 if size < SMALLEST else size - SMALLEST)


@functools.cache
def shape_contents(config: EngineConfig) -> ShapeContents:
    """Return what the ROM of a configuration holds.

    Raises
    ------
    ValueError
        If the configuration has no ROM, or the sizes below 4 have more shapes than ``TINY`` bits
        count.
    """
    if config.largest_shape < BLOCK:
        raise ValueError(f"an engine with shapes={config.shapes!r} has no shape ROM")
    table = folded_shapes()
    held = {
        (size, fraction): table[size, ..., fraction]
        for size in range(config.largest_shape + 1)
        for fraction in range(FRACTIONS if size > BLOCK else 1)
    }
    # The shapes of the small sizes have the small numbers.
    tiny = np.unique(np.stack([held[size, 0] for size in range(SMALLEST)]))
    if len(tiny) >= 1 << TINY:
        raise ValueError(f"{len(tiny)} shapes below size {SMALLEST} do not fit {TINY} bits")
    every = np.unique(np.stack(list(held.values())))
    shapes = np.concatenate([tiny, np.setdiff1d(every, tiny)])
    order = np.argsort(shapes)
    rows = np.zeros((_row_of(0, 0, config) + 1, FOLDED, FOLDED), np.int64)
    for (size, fraction), scans in held.items():
        place = order[np.searchsorted(shapes, scans, sorter=order)] + 1
        shift = TINY * max(size - 1, 0) if size < SMALLEST else 0
        row = rows[_row_of(size, fraction, config)]
        row |= np.where(size == 1, 0, place << shift)  # size 0 has written the same
    return ShapeContents(rows.ravel().tolist(), [0, *(_entry(int(scans)) for scans in shapes)])


def _entry(scans: int) -> int:
    """Return a shape with its rows' bits."""
    empty = [(scans >> 6 * row & 63) == (EMPTY & 63) for row in range(ROWS)]
    return scans | sum(flag << 6 * ROWS + row for row, flag in enumerate(empty))
