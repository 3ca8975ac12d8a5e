"""Small clouds that tests share."""

import numpy as np

from splatline.host.cloud.cloud import Cloud

__all__ = ["cloud_of", "sphere"]


def cloud_of(positions, normals, colours=None, two_sided=False):
    """Return a cloud of points about the origin."""
    positions = np.asarray(positions, np.float64).reshape(-1, 3)
    normals = np.asarray(normals, np.float32).reshape(-1, 3)
    if colours is None:
        colours = np.full((len(positions), 3), 200)
    return Cloud(
        positions,
        normals,
        np.asarray(colours, np.uint8).reshape(-1, 3),
        np.full(len(positions), two_sided),
        np.zeros(3),
        "test",
        {},
    )


def sphere(count=2000, seed=1):
    """Return points on the unit sphere with three colours."""
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(count, 3))
    positions /= np.linalg.norm(positions, axis=1, keepdims=True)
    colours = np.array([[250, 40, 30], [30, 200, 60], [40, 60, 240]])[rng.integers(0, 3, count)]
    return cloud_of(positions, positions, colours)
