"""The picture that an engine draws: depth and colour of each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .config import EngineConfig
from .presets import PAPER

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
        """Return a raster of background."""
        depth = np.full((height, width), config.background_depth, np.uint16)
        return cls(depth, np.zeros((height, width, 3), np.uint8), config)

    @classmethod
    def from_words(
        cls,
        depth: npt.NDArray[np.uint16],
        colour_words: npt.NDArray[np.uint32],
        config: EngineConfig = PAPER,
    ) -> Raster:
        """Return a raster from stored colours.

        Parameters
        ----------
        depth
            Shape (height, width), uint16; copied.
        colour_words
            Shape (height, width), uint32: a stored colour of ``config.colour_bits`` bits, red
            lowest, then green, then blue.
        config
            The engine's configuration.
        """
        colour = np.empty((*depth.shape, 3), np.uint8)
        for channel in range(3):
            shift = np.uint32(channel * config.channel_bits)
            colour[..., channel] = (colour_words >> shift) & np.uint32(config.channel_max)
        return cls(depth.copy(), colour, config)

    @property
    def colour_words(self) -> npt.NDArray[np.uint32]:
        """The stored colours, as ``from_words`` takes them: shape (height, width)."""
        words = np.zeros(self.depth.shape, np.uint32)
        for channel in range(3):
            shift = np.uint32(channel * self.config.channel_bits)
            words |= self.colour[..., channel].astype(np.uint32) << shift
        return words

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """Where anything was drawn: shape (height, width)."""
        return np.not_equal(self.depth, self.config.background_depth)

    def part(self, lines: slice, columns: slice) -> Raster:
        """Return some lines and columns of the raster; its arrays are views."""
        return Raster(self.depth[lines, columns], self.colour[lines, columns], self.config)

    def to_rgb(
        self, background: tuple[float, float, float] = (1.0, 1.0, 1.0)
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
        """Count the pixels whose depth or colour differs from another raster's.

        Raises
        ------
        ValueError
            If the rasters have different sizes or configurations.
        """
        return int(np.count_nonzero(self.differs(other)))

    def differs(self, other: Raster) -> npt.NDArray[np.bool_]:
        """Return where depth or colour differs from another raster's: shape (height, width).

        Raises
        ------
        ValueError
            If the rasters have different sizes or configurations.
        """
        if self.depth.shape != other.depth.shape:
            raise ValueError(f"rasters of {self.depth.shape} and {other.depth.shape} pixels")
        if self.config != other.config:
            raise ValueError("rasters of two configurations have no colour in common")
        same = np.equal(self.colour, other.colour).all(axis=2)
        return np.not_equal(self.depth, other.depth) | ~same
