"""Surfaces of built-in scenes as patches of two coordinates, and clouds sampled from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from splatline.host.cloud.cloud import Cloud

__all__ = ["GOLDEN", "Patch", "sample"]

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0

_Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Patch:
    """A piece of a true surface.

    Parameters
    ----------
    area
        Its area, or its share of the points.
    at
        Positions (n, 3), unit normals (n, 3) and colours (n, 3) at two coordinates in 0..1. Equal
        areas of the coordinates have equal shares of the points.
    """

    area: float
    at: Callable[[_Floats, _Floats], tuple[_Floats, _Floats, npt.NDArray[np.uint8]]]


def sample(patches: Sequence[Patch], count: int, name: str, seed: int | None = None) -> Cloud:
    """Return a cloud of points on patches, about the middle of its bounding box.

    Parameters
    ----------
    patches
        Each has its share of the points by area.
    count
        Points of all patches together.
    name
        The cloud's name.
    seed
        Of points at random. None: on each patch they follow a golden-ratio lattice, so that all
        neighbours are about equally far apart.
    """
    areas = np.cumsum([0.0, *(patch.area for patch in patches)])
    bounds = np.rint(areas / areas[-1] * count).astype(int)
    rng = None if seed is None else np.random.default_rng(seed)
    parts = [
        patch.at(*_coordinates(int(size), rng))
        for patch, size in zip(patches, np.diff(bounds), strict=True)
    ]
    positions, normals, colours = (np.concatenate(column) for column in zip(*parts, strict=True))
    middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    return Cloud(
        positions=positions - middle,
        normals=normals.astype(np.float32),
        colours=colours,
        two_sided=np.zeros(len(positions), np.bool_),
        origin=middle,
        name=name,
        dropped={},
    )


def _coordinates(count: int, rng: np.random.Generator | None) -> tuple[_Floats, _Floats]:
    """Return coordinates in 0..1, evenly spread or at random."""
    if rng is not None:
        return rng.random(count), rng.random(count)
    index = np.arange(count, dtype=np.float64)
    return (index + 0.5) / count, index * GOLDEN % 1.0
