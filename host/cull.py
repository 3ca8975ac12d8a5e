"""What a view does not show of a cloud, point by point."""

from __future__ import annotations

import numba as nb

__all__ = ["FACING_AWAY", "KEPT", "OUTSIDE", "REASONS", "faces_away", "lies_outside"]

KEPT, OUTSIDE, FACING_AWAY = 0, 1, 2

REASONS = {OUTSIDE: "outside", FACING_AWAY: "facing_away"}
"""Names of the reasons, as the statistics give them."""

MARGIN = 1.5
"""Pixels by which a drawn footprint may reach beyond its true circle: a centre rounded to a whole
pixel and a diameter rounded up."""


@nb.njit(inline="always")
def lies_outside(column: float, line: float, radius: float, width: int, height: int) -> bool:
    """Return whether a splat cannot touch the image (all lengths in pixels)."""
    reach = radius + MARGIN
    return not (-reach < column < width + reach and -reach < line < height + reach)


@nb.njit(inline="always")
def faces_away(facing: float) -> bool:
    """Return whether a surface shows its back; ``facing`` is n . (p - eye), up to a factor."""
    return facing >= 0.0
