"""Measures of a surface that is not whole: pinholes, and pixels that show a layer behind.

Neither needs a reference. A true surface has some of both where its own outline is thin, so the
same measures of the truth stand beside those of a picture.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.sim.golden.multisample import Drawn

from .reference import Reference

__all__ = [
    "ENCLOSED",
    "LARGEST_GAP",
    "STEP",
    "behind_truth",
    "largest_gap",
    "pinholes",
    "see_through",
    "wholeness",
]

ENCLOSED = 7
"""Drawn neighbours, of eight, of a background pixel that is a pinhole."""

STEP = 25.0 / 511.0
"""Share of the depth range by which a pixel that is seen through lies behind its neighbours."""

LARGEST_GAP = 40
"""Most pixels of a gap; a larger area of background is taken for a true one."""

_Mask = npt.NDArray[np.bool_]
_Floats = npt.NDArray[np.float64]


def wholeness(raster: Drawn) -> dict[str, float]:
    """Return a picture's pinholes and see-through pixels as shares of the pixels drawn.

    Parameters
    ----------
    raster
        The picture; depth 0 and its largest depth are the ends of the depth range.

    Returns
    -------
    dict
        ``pinholes`` and ``see_through``; 0 where nothing is drawn.
    """
    drawn = raster.drawn
    total = max(int(np.count_nonzero(drawn)), 1)
    depth = raster.depth / max(raster.config.background_depth - 1, 1)
    return {
        "pinholes": int(np.count_nonzero(pinholes(drawn))) / total,
        "see_through": int(np.count_nonzero(see_through(depth, drawn))) / total,
    }


def pinholes(drawn: _Mask) -> _Mask:
    """Return the background pixels of which at least ``ENCLOSED`` of eight neighbours are drawn.

    Parameters
    ----------
    drawn
        Where a surface is seen: shape (height, width). Nothing is drawn outside of the image.
    """
    around = np.sum(_neighbourhood(drawn, False), axis=0, dtype=np.int64)
    return ~drawn & (around >= ENCLOSED)


def largest_gap(drawn: _Mask) -> int:
    """Return the pixels of the largest gap: a small area of background within a surface.

    It has at most ``LARGEST_GAP`` pixels, and no other background lies within three pixels of it,
    as it does where an outline is frayed.

    Parameters
    ----------
    drawn
        Where a surface is seen: shape (height, width).
    """
    from scipy.ndimage import binary_dilation, label

    touching = np.ones((3, 3), np.bool_)
    numbers, count = label(binary_dilation(~drawn, touching), touching)
    sizes = np.bincount(numbers[~drawn], minlength=count + 1)
    return int(max(sizes[sizes <= LARGEST_GAP], default=0))


def see_through(depth: npt.NDArray[np.floating], drawn: _Mask) -> _Mask:
    """Return the drawn pixels more than ``STEP`` behind the median of their 3 x 3 neighbourhood.

    Parameters
    ----------
    depth
        Share of the depth range: shape (height, width).
    drawn
        Where it counts; the median is over the drawn pixels of the neighbourhood.
    """
    stack = _neighbourhood(np.where(drawn, depth, np.nan).astype(np.float64), np.nan)
    flagged = np.zeros(drawn.shape, np.bool_)
    flagged[drawn] = depth[drawn] - np.nanmedian(stack[:, drawn], axis=0) > STEP
    return flagged


def behind_truth(
    raster: Drawn, truth: Reference, depth_range: tuple[float, float] | list[float]
) -> float:
    """Return the share of the drawn pixels that lie behind the true surface.

    Such a pixel is more than ``STEP`` behind all of the truth in its 3 x 3 neighbourhood. Pixels
    whose neighbourhood has true background count as well; its own depth does not.

    Parameters
    ----------
    raster
        The picture.
    truth
        The true surface in the same view.
    depth_range
        Distances along the view of depth 0 and of the largest depth.
    """
    low, high = depth_range
    known = np.where(truth.coverage > 0.0, truth.depth, -np.inf)
    furthest = np.max(_neighbourhood(known, -np.inf), axis=0)
    drawn = raster.drawn
    depth = low + raster.depth / max(raster.config.background_depth - 1, 1) * (high - low)
    behind = drawn & np.isfinite(furthest) & (depth > furthest + STEP * (high - low))
    return int(np.count_nonzero(behind)) / max(int(np.count_nonzero(drawn)), 1)


def _neighbourhood(values: npt.NDArray[Any], outside: Any) -> npt.NDArray[Any]:
    """Return the nine shifts of an image: shape (9, height, width)."""
    height, width = values.shape
    padded = np.pad(values, 1, constant_values=outside)
    return np.stack(
        [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0
    )
