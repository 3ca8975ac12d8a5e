"""The fields of a plane word beside those of any code word, and the constants of its arithmetic.

``docs/contract.md``, "Plane words", describes them. A plane word has 96 bits. Its low 64 bits hold
MODE, SCANS, the look, X and the sides; its high 32 bits hold the plane.
"""

from __future__ import annotations

from .fields import Field

__all__ = [
    "LOW_BITS",
    "PLANE_BITS",
    "SHIFTS",
    "SIDES",
    "SUM_FRACTION",
    "Z_FRACTION",
    "PlaneFields",
]

LOW_BITS = 64
"""Bits of a code word without a plane, and of the low half of a plane word."""

PLANE_BITS = 96
"""Bits of a plane word."""

SIDES = 8
"""Ends of the four rotated rows; a bit for each moves it by a column."""

Z_FRACTION = 1
"""Fraction bits of a plane word's Z."""

SUM_FRACTION = 2
"""Fraction bits of a slope, and of the sum that gives a pixel's depth."""

SHIFTS = (0, 1, 2, 4)
"""Places by which each value of SCALE shifts both slopes to the left."""


class PlaneFields:
    """The further fields of a plane word; they mean nothing in a configuration without planes."""

    slope_bits: int

    def side(self, row: int, end: int) -> Field:
        """Whether an end of row 0..3 rotated is moved: ``end`` 0 for its first column, 1: last."""
        return Field(LOW_BITS - SIDES + 2 * row + end, 1)

    @property
    def raised(self) -> Field:
        """1: row 3 is the middle of a symmetric shape; 0: the middle lies below row 3."""
        return Field(LOW_BITS, 1)

    def outwards(self, end: int) -> Field:
        """Where the moved first (``end`` 0) or last (1) columns go. 0: inwards, 1: outwards."""
        return Field(LOW_BITS + 1 + end, 1)

    @property
    def slope_x(self) -> Field:
        """Change of depth from column to column, signed, before the shift by SCALE."""
        return Field(LOW_BITS + 3, self.slope_bits)

    @property
    def slope_y(self) -> Field:
        """Change of depth from line to line, signed, before the shift by SCALE."""
        return Field(self.slope_x.end, self.slope_bits)

    @property
    def scale(self) -> Field:
        """Index into ``SHIFTS``."""
        return Field(self.slope_y.end, 2)
