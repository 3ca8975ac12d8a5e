"""How far apart a cloud's points lie, and how large a disc each needs to close the surface."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from .cloud import Cloud
from .errors import InputError

__all__ = ["point_spacing", "splat_radii"]

NEIGHBOURS = 8
"""Nearest neighbours that a point's spacing is measured from."""

COVER = 0.85
"""Radius of a disc for a spacing of 1; a square grid is closed from 0.71 on."""


def splat_radii(cloud: Cloud, size: float | None = None) -> npt.NDArray[np.float64]:
    if size is not None:
        if not (math.isfinite(size) and size > 0.0):
            raise InputError(f"the splat size must be above 0, not {size:g}")
        return np.full(len(cloud), 0.5 * size)
    from scipy.spatial import cKDTree

    d = cKDTree(cloud.positions).query(cloud.positions, NEIGHBOURS + 1, workers=-1)[0][:, -1]
    return COVER * d * math.sqrt(math.pi / (NEIGHBOURS + 1))
