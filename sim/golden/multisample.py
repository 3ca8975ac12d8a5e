"""Multisampling: the mean of several rasters, one for each sample of a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from splatline.contract.config import EngineConfig
from splatline.contract.raster import Raster

__all__ = ["Average", "Drawn", "average", "mismatches"]


@dataclass(frozen=True)
class Average:
    """A picture of several samples a pixel: one raster for each sample.

    Parameters
    ----------
    rasters
        At least one raster; all of one size and configuration.
    """

    rasters: tuple[Raster, ...]

    @property
    def config(self) -> EngineConfig:
        """The engine's configuration."""
        return self.rasters[0].config

    @property
    def coverage(self) -> npt.NDArray[np.float64]:
        """Share of each pixel's samples that were drawn: shape (height, width)."""
        return np.mean([raster.drawn for raster in self.rasters], axis=0)

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """Where at least half of the samples were drawn: shape (height, width)."""
        return self.coverage >= 0.5

    @property
    def depth(self) -> npt.NDArray[np.uint16]:
        """The mean of the drawn samples, where at least half are; else the background's."""
        total = np.zeros(self.rasters[0].depth.shape)
        count = np.zeros(total.shape)
        for raster in self.rasters:
            total += np.where(raster.drawn, raster.depth, 0)
            count += raster.drawn
        mean = np.rint(total / np.maximum(count, 1)).astype(np.uint16)
        return np.where(self.drawn, mean, np.uint16(self.config.background_depth))

    def to_rgb(
        self, background: tuple[float, float, float] = (1.0, 1.0, 1.0)
    ) -> npt.NDArray[np.float64]:
        """Return the mean picture as float64 RGB in 0..1; see :meth:`Raster.to_rgb`."""
        total = self.rasters[0].to_rgb(background)
        for raster in self.rasters[1:]:
            total += raster.to_rgb(background)
        return total / len(self.rasters)


Drawn: TypeAlias = Raster | Average
"""A drawn picture, of one sample a pixel or of several."""


def average(rasters: Sequence[Raster]) -> Drawn:
    """Return the mean of the samples' rasters; a single raster is returned as it is."""
    return rasters[0] if len(rasters) == 1 else Average(tuple(rasters))


def mismatches(one: Drawn, other: Drawn) -> int:
    """Count the pixels at which two pictures differ, in depth or colour of any sample.

    Raises
    ------
    ValueError
        If the pictures have different sizes, configurations or numbers of samples.
    """
    pairs = zip(_rasters(one), _rasters(other), strict=True)
    return int(np.count_nonzero(np.any([mine.differs(its) for mine, its in pairs], axis=0)))


def _rasters(picture: Drawn) -> tuple[Raster, ...]:
    """Return the rasters of a picture's samples."""
    return picture.rasters if isinstance(picture, Average) else (picture,)
