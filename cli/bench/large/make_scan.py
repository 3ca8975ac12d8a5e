"""Makes a LAZ file of any size: the built-in terrain, as an aeroplane would scan it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.host.scenes.terrain import terrain_patches

__all__ = ["make_scan"]

LINES = 40
"""Flight lines, from west to east."""

OVERLAP = 0.3
"""Share of a line's width that the next one sees too."""

SWEEPS = 8000
"""Sweeps of the scanner along a line."""

NOISE = 0.4
"""Standard deviation of a point's height, in metres."""

PIECE = 1 << 20

OFFSETS = (680_000.0, 4_030_000.0, 0.0)
"""Metres, about those of UTM zone 16N: coordinates as large as those of real scans."""

SCALE = 0.001


def make_scan(
    path: Path, points: int, seed: int = 1, *, progress: Callable[[float], None] | None = None
) -> None:
    """Write a LAZ file of version 1.4, point format 7: coordinates, 16-bit colours, intensity.

    Parameters
    ----------
    path
        The file.
    points
        How many.
    seed
        Of the noise.
    progress
        Called now and then with the share that is written.
    """
    import laspy

    (patch,) = terrain_patches()
    rng = np.random.default_rng(seed)
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales, header.offsets = np.full(3, SCALE), np.array(OFFSETS)
    with laspy.open(path, mode="w", header=header) as writer:
        for start in range(0, points, PIECE):
            count = min(PIECE, points - start)
            east, south = _places(start + np.arange(count), points)
            positions, _, colours = patch.at(east, south)
            positions[:, 2] += rng.normal(0.0, NOISE, count)
            record = laspy.ScaleAwarePointRecord.zeros(count, header=header)
            record.x, record.y, record.z = positions.T + np.array(OFFSETS)[:, np.newaxis]
            shade = 1.0 + rng.normal(0.0, 0.06, (count, 1))
            bright = np.clip(colours * shade, 0.0, 255.0).astype(np.uint16) * 257
            record.red, record.green, record.blue = bright.T
            record.intensity = bright.mean(axis=1).astype(np.uint16)
            record.gps_time = (start + np.arange(count)) * 1e-6
            record.classification[:] = 2  # ground
            writer.write_points(record)
            if progress is not None:
                progress((start + count) / points)


def _places(
    numbers: npt.NDArray[np.int64], points: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return where points lie, as shares of the way east and south."""
    along = numbers / points * LINES
    line = np.floor(along)
    along -= line
    sweep = along * SWEEPS
    swing = np.abs(2.0 * (sweep - np.floor(sweep)) - 1.0)
    east = (line + (1.0 + OVERLAP) * swing - 0.5 * OVERLAP) / LINES
    south = np.where(line % 2 == 0, along, 1.0 - along)
    return np.clip(east, 0.0, 1.0), south
