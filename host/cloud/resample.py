"""A larger cloud on the same surface, for measurements with millions of points."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

from .cloud import Cloud

__all__ = ["resample"]


def resample(
    cloud: Cloud, radii: npt.NDArray[np.floating[Any]], count: int, seed: int = 1
) -> tuple[Cloud, npt.NDArray[np.float64]]:
    """Return a cloud of ``count`` points on the discs of another, and the radii of its own discs.

    Each point lies at random, evenly by area, on the inner 0.6 of a random disc. The new discs have
    together the area of the old ones if there are more points.

    Parameters
    ----------
    cloud
        The cloud whose surface is sampled.
    radii
        Of its discs: shape (n,).
    count
        Points wanted.
    seed
        Of the random numbers.
    """
    rng = np.random.default_rng(seed)
    source = rng.integers(0, len(cloud), count)
    normals = cloud.normals[source].astype(np.float64)
    across = rng.normal(size=(count, 3))
    across -= normals * np.einsum("ij,ij->i", normals, across)[:, np.newaxis]
    lengths = np.linalg.norm(across, axis=1)
    # A random direction along the normal is next to impossible. The point stays at the middle.
    reach = 0.6 * radii[source] * np.sqrt(rng.random(count)) / np.where(lengths > 0, lengths, 1.0)
    sampled = dataclasses.replace(
        cloud,
        positions=cloud.positions[source] + across * reach[:, np.newaxis],
        normals=cloud.normals[source],
        colours=cloud.colours[source],
        two_sided=cloud.two_sided[source],
        name=f"{cloud.name}, {count:,} points",
    )
    smaller = np.sqrt(min(1.0, len(cloud) / count)) if count else 1.0
    return sampled, np.asarray(radii, np.float64)[source] * smaller
