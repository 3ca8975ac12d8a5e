"""The contents of the shape ROM's two memories: numbers of shapes, and each shape once."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from splatline.contract.config import BLOCK, ROWS, EngineConfig

from .table import EMPTY, FOLDED, folded_shapes

__all__ = ["SMALLEST", "TINY", "ShapeContents", "shape_contents"]

SMALLEST = 4
"""Sizes below this one share a row of numbers, because together they have few shapes."""

TINY = 3
"""Bits of a number of such a size."""

FRACTIONS = 4
"""Fractions of the upper half of a size over 8. The two of the same lines share a word."""


@dataclass(frozen=True)
class ShapeContents:
    """The initial contents of both memories.

    Parameters
    ----------
    numbers
        By row (see ``_row_of``), then by n'x and n'y as in ``folded_shapes``: the number of a shape
        in ``shapes``, or two of them side by side, the first in the lower bits. The number is 0
        for a fraction without pixels. The last row holds three numbers of ``TINY`` bits instead, of
        the sizes 0 and 1 (which are the same), 2 and 3.
    shapes
        SCANS, and above them a bit for each empty row. Entry 0 is no shape: all its bits are 0.
    abreast
        Numbers in a word: 2 if there are sizes over 8, else 1.
    """

    numbers: list[int]
    shapes: list[int]
    abreast: int

    @property
    def number_bits(self) -> int:
        """Bits of a number of a shape."""
        return (len(self.shapes) - 1).bit_length()

    @property
    def word_bits(self) -> int:
        """Bits of a word of numbers."""
        return self.abreast * self.number_bits

    @property
    def shape_bits(self) -> int:
        """Bits of an entry of ``shapes``."""
        return 7 * ROWS


def _row_of(size: int, fraction: int, abreast: int) -> tuple[int, int]:
    """Return the row of a size's numbers, and their position in its words.

    Sizes over 8 come first, by the three lowest bits of the size (16 before 9) and the fraction,
    left and right in one word. Sizes 4 to 8 follow, and then the row of the smaller sizes. This
    order needs few gates.
    """
    if size > BLOCK:
        return divmod(FRACTIONS * (size % BLOCK) + fraction, abreast)
    large = BLOCK * FRACTIONS if abreast > 1 else 0
    return divmod(large + (5 if size < SMALLEST else size - SMALLEST), abreast)


@functools.cache
def shape_contents(config: EngineConfig) -> ShapeContents:
    """Return the contents of a configuration's ROM.

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
    places = [EMPTY, *tiny, *np.setdiff1d(every, [EMPTY, *tiny])]
    order = np.argsort(places)
    abreast = 2 if config.largest_shape > BLOCK else 1
    number_bits = (len(places) - 1).bit_length()
    rows = np.zeros((_row_of(0, 0, abreast)[0] + 1, FOLDED, FOLDED), np.int64)
    for (size, fraction), scans in held.items():
        place = order[np.searchsorted(places, scans, sorter=order)]
        row, side = _row_of(size, fraction, abreast)
        shift = number_bits * side + (TINY * max(size - 1, 0) if size < SMALLEST else 0)
        rows[row] |= np.where(size == 1, 0, place << shift)  # size 0 has written the same
    shapes = [0, *(_entry(int(scans)) for scans in places[1:])]
    return ShapeContents(rows.ravel().tolist(), shapes, abreast)


def _entry(scans: int) -> int:
    """Return a shape with a bit for each empty row."""
    empty = [(scans >> 6 * row & 63) == (EMPTY & 63) for row in range(ROWS)]
    return scans | sum(flag << 6 * ROWS + row for row, flag in enumerate(empty))
