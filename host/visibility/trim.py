"""Trims small discs, for pictures whose specks are closed in the image.

Discs that overlap close a surface that bends, and cover more than the surface at its outline. What
small discs leave open is small as well, and ``close_specks`` closes nearly all of it. So they need
not overlap (decision 0116).
"""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt

from .view import View

__all__ = ["trim", "trimmed_radii"]

SMALL = 8.0
"""Radius in pixels up to which a disc is trimmed to its closing radius."""

LARGE = 16.0
"""Radius in pixels from which on a disc is not trimmed: its gaps are far larger than specks."""

PER_PIXEL = 1.0 / (LARGE - SMALL)


@nb.njit(inline="always")
def trim(pixels: float, excess: float) -> float:
    """Return a disc's radius in pixels when it is trimmed; it grows as ``pixels`` does.

    Parameters
    ----------
    pixels
        Its radius.
    excess
        Share of it that a small disc loses: 1 - 1 / ``Discs.cover``.
    """
    return pixels - excess * min(max((LARGE - pixels) * PER_PIXEL, 0.0), 1.0) * pixels


def trimmed_radii(
    positions: npt.NDArray[np.float64],
    radii: npt.NDArray[np.float64],
    view: View,
    cover: float,
) -> npt.NDArray[np.float64]:
    """Return the radii of discs as a view shows them when they are trimmed, in the cloud's unit.

    Parameters
    ----------
    positions, radii
        Shapes (n, 3) and (n,), float64.
    view
        The view.
    cover
        See ``Discs``.
    """
    if cover == 1.0:
        return radii
    depth = np.maximum((positions - view.eye) @ view.axes[2], view.near)
    pixels = radii * view.focal / depth
    small = np.clip((LARGE - pixels) * PER_PIXEL, 0.0, 1.0)
    return radii * (1.0 - (1.0 - 1.0 / cover) * small)
