"""The coordinates of an E57 file's scans: from spherical ones, and moved by a scan's pose."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

__all__ = ["cartesian", "moved"]


def cartesian(spherical: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return Cartesian coordinates of range, azimuth and elevation in radians: shape (n, 3)."""
    distance, azimuth, elevation = spherical.T
    flat = distance * np.cos(elevation)
    return np.stack(
        [flat * np.cos(azimuth), flat * np.sin(azimuth), distance * np.sin(elevation)], axis=-1
    )


def moved(
    scan: Any, rows: npt.NDArray[np.float64], *, turn_only: bool = False
) -> npt.NDArray[np.float64]:
    """Return rows rotated by a scan's pose, and moved unless they are directions."""
    if not scan.isDefined("pose"):
        return rows
    pose = scan["pose"]
    if pose.isDefined("rotation"):
        w, *xyz = (float(pose["rotation"][name].value()) for name in "wxyz")
        x, y, z = xyz
        size = w * w + x * x + y * y + z * z
        if not 0.0 < size < np.inf:
            raise InputError("has a scan whose rotation is none; is it damaged?")
        # w + xi + yj + zk as a matrix; a quaternion of any length is a rotation.
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        matrix = np.eye(3) + (2.0 / size) * (w * cross + cross @ cross)
        rows = rows @ matrix.T
    if pose.isDefined("translation") and not turn_only:
        rows = rows + [float(pose["translation"][name].value()) for name in "xyz"]
    return rows
