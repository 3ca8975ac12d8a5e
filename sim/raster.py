"""The picture that an engine draws: depth and colour, as the golden renderer and the RTL give it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..rtl.format import PAPER, EngineConfig

__all__ = ["Raster"]


@dataclass(frozen=True)
class Raster:
    """Depth and colour of every pixel, in the engine's own integers.

    Parameters
    ----------
    depth
        Shape (height, width), uint16; ``config.background_depth`` where nothing was drawn.
    colour
        Shape (height, width, 3), uint8: red, green, blue levels in 0..``config.channel_max``;
        0 where nothing was drawn.
    config
        The engine's configuration.
    """

    depth: npt.NDArray[np.uint16]
    colour: npt.NDArray[np.uint8]
    config: EngineConfig = PAPER

    @classmethod
    def background(cls, width: int, height: int, config: EngineConfig = PAPER) -> Raster:
        """Return an image that nothing was drawn into."""
        depth = np.full((height, width), config.background_depth, np.uint16)
        return cls(depth, np.zeros((height, width, 3), np.uint8), config)

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """Where anything was drawn: shape (height, width)."""
        return self.depth != self.config.background_depth

    def to_rgb(self, background: tuple[float, float, float] = (1.0, 1.0, 1.0)
               ) -> npt.NDArray[np.float64]:
        """Return the picture as float64 RGB in 0..1, shape (height, width, 3).

        Parameters
        ----------
        background
            RGB in 0..1 of the pixels that nothing was drawn into.
        """
        rgb = self.colour / float(self.config.channel_max)
        return np.where(self.drawn[..., np.newaxis], rgb, np.asarray(background, np.float64))

    def mismatches(self, other: Raster) -> int:
        """Count the pixels whose depth or colour differs from another raster's."""
        if self.depth.shape != other.depth.shape:
            raise ValueError(f"rasters of {self.depth.shape} and {other.depth.shape} pixels")
        differs = (self.depth != other.depth) | (self.colour != other.colour).any(axis=2)
        return int(np.count_nonzero(differs))
