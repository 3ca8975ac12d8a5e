"""Quantised normals: levels of n', the index of the shape table and of the shade tables."""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt

__all__ = ["LEVELS", "level_slopes", "quantise", "quantise_slopes"]

LEVELS = 64
"""Levels of n'x and of n'y in the shape table."""


@nb.njit(inline="always")
def quantise(part: float, facing: float, levels: int) -> int:
    """Return the level of the slope n' = ``part / facing``, with ``facing < 0``.

    Levels are even steps of n' / (1 + |n'|), which lies in -1..1. So levels are fine where shapes
    and shades change most, and no slope is too large. They need no arc tangent, unlike steps even
    in angle (decision 0007).
    """
    level = int((0.5 - 0.5 * part / (abs(part) - facing)) * levels)
    return min(max(level, 0), levels - 1)


@nb.njit(inline="always")
def quantise_slopes(slope_x: float, slope_y: float, levels: int) -> tuple[int, int]:
    """Return the levels of a disc's slopes n'x and n'y.

    The last level stands for the slope ``levels`` - 1. A disc that is seen more nearly edge on has
    both slopes made smaller by one factor: so its ellipse keeps its direction.
    """
    steep = max(abs(slope_x), abs(slope_y))
    share = (levels - 1) / steep if steep > levels - 1 else 1.0
    return quantise(-share * slope_x, -1.0, levels), quantise(-share * slope_y, -1.0, levels)


def level_slopes(levels: int = LEVELS) -> npt.NDArray[np.float64]:
    """Return the slope n' in the middle of each level: shape (levels,)."""
    middle = (np.arange(levels) + 0.5) / (0.5 * levels) - 1.0
    return middle / (1.0 - np.abs(middle))
