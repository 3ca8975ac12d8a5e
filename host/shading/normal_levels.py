"""Quantised normals: the levels of n' that shapes and shades are looked up by."""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt

__all__ = ["LEVELS", "level_slopes", "quantise"]

LEVELS = 64
"""Levels of n'x and of n'y in the shape table."""


@nb.njit(inline="always")
def quantise(part: float, facing: float, levels: int) -> int:
    """Return which of the levels the slope n' = ``part / facing`` has, with ``facing < 0``.

    Levels are even steps of n' / (1 + |n'|), which lies in -1..1: so they are fine where shapes and
    shades change most, and no slope is too large. Measured against steps even in angle
    (decision 0007), and free of an arc tangent.
    """
    level = int((0.5 - 0.5 * part / (abs(part) - facing)) * levels)
    return min(max(level, 0), levels - 1)


def level_slopes(levels: int = LEVELS) -> npt.NDArray[np.float64]:
    """Return the slope n' that each level stands for, its middle: shape (levels,)."""
    middle = (np.arange(levels) + 0.5) / (0.5 * levels) - 1.0
    return middle / (1.0 - np.abs(middle))
