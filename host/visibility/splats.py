"""Splats: the points that a view may show, as ellipses on the image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["COLUMN", "DEPTH", "DIAMETER", "LINE", "LOOK", "SLOPE_X", "SLOPE_Y", "SPLAT", "Splats"]

SPLAT = np.dtype(
    [
        ("column", np.float32),  # centre on the image, in pixels
        ("line", np.float32),
        ("diameter", np.float32),  # of the disc seen face on, in pixels
        ("slope_x", np.float32),  # n'x and n'y
        ("slope_y", np.float32),
        ("look", np.uint32),  # DIFFUSE, SPECULAR and MATERIAL as they lie in a code word
        ("depth", np.float64),  # distance along the view, in the cloud's unit
    ]
)
"""A splat: 32 bytes."""

COLUMN, LINE, DIAMETER, SLOPE_X, SLOPE_Y = range(5)
"""Numbers of the first fields among a splat's eight float32."""

LOOK = 5
"""Number of the look among a splat's eight uint32."""

DEPTH = 3
"""Number of the depth among a splat's four float64."""


@dataclass(frozen=True)
class Splats:
    """The points that a view may show, as ellipses on the image.

    Parameters
    ----------
    data
        Splats in chunks, with gaps between: shape (slots,), structured, see ``SPLAT``.
    starts, stops
        The slots of each chunk: shape (CHUNKS,), int64.
    nearest
        Least depth of each chunk; infinite if it is empty: shape (CHUNKS,), float64.
    depth_range
        Least and greatest depth; (0, 0) if there is no splat.
    culled
        Points left out, by reason.
    """

    data: npt.NDArray[Any]
    starts: npt.NDArray[np.int64]
    stops: npt.NDArray[np.int64]
    nearest: npt.NDArray[np.float64]
    depth_range: tuple[float, float]
    culled: dict[str, int]

    def __len__(self) -> int:
        """Return the number of splats."""
        return int((self.stops - self.starts).sum())

    def views(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]:
        """Return the data as float32 and uint32, (slots, 8), and as float64, (slots, 4).

        Compiled code works on these views. Each use of a structured row counts references, which
        takes longer than all of the projection.
        """
        slots = len(self.data)
        kinds = (np.float32, 8), (np.uint32, 8), (np.float64, 4)
        first, second, third = (self.data.view(kind).reshape(slots, n) for kind, n in kinds)
        return first, second, third

    def together(self) -> npt.NDArray[Any]:
        """Return the splats without gaps: shape (m,), structured."""
        parts = zip(self.starts, self.stops, strict=True)
        return np.concatenate([self.data[start:stop] for start, stop in parts])

    @classmethod
    def of(cls, data: npt.NDArray[Any]) -> Splats:
        """Return splats given as one array, in a single chunk."""
        limits = (float(data["depth"].min()), float(data["depth"].max())) if len(data) else (0, 0)
        return cls(data, np.array([0]), np.array([len(data)]), np.zeros(1), limits, {})
