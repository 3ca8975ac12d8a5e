"""The usual size of a cloud's discs, measured in parts of it if it is large."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from .bulk import far_points, select
from .cloud import Cloud
from .normals import estimate_normals
from .spacing import measure_discs

__all__ = ["typical_size"]

LARGE = 400_000
"""Points from which parts are measured."""

PARTS = 12
"""Boxes that are measured."""

PART_POINTS = 4096
"""Points that a box should hold."""

SAMPLE = 100_000
"""Points by which the boxes' size is chosen."""

HALVINGS = 20
"""Most times that the boxes are halved."""


def typical_size(cloud: Cloud) -> float:
    """Return twice the median radius of the discs (see ``measure_discs``), in the cloud's unit.

    A large cloud is measured in ``PARTS`` boxes about some of its points, chosen at random by a
    fixed seed. Normals that are missing there are estimated.
    """
    if len(cloud) >= LARGE:
        cloud = select(cloud, _in_boxes(cloud.positions))
    if cloud.two_sided.any():
        normals = cloud.normals.copy()
        normals[cloud.two_sided] = estimate_normals(
            cloud.positions, cloud.two_sided, cells=cloud.cells
        )
        cloud = dataclasses.replace(cloud, normals=normals)
    return float(2.0 * np.median(measure_discs(cloud).radii))


def _in_boxes(positions: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return which points lie in one of ``PARTS`` boxes of a grid."""
    step = max(1, len(positions) // SAMPLE)
    sample = positions[::step]
    sample = sample[~far_points(sample)]
    low = sample.min(axis=0)
    side = float((sample.max(axis=0) - low).max()) or 1.0
    boxes = _boxes(sample, low, side)
    for _ in range(HALVINGS):
        _, which, counts = np.unique(boxes, return_inverse=True, return_counts=True)
        if np.median(counts[which]) * step <= PART_POINTS:
            break
        side *= 0.5
        boxes = _boxes(sample, low, side)
    chosen = np.random.default_rng(0).choice(boxes, min(PARTS, len(boxes)), replace=False)
    inside: npt.NDArray[np.bool_] = np.isin(_boxes(positions, low, side), chosen)
    return inside


def _boxes(
    positions: npt.NDArray[np.float64], low: npt.NDArray[np.float64], side: float
) -> npt.NDArray[np.int64]:
    """Return a number for the box of each point; those far away share boxes with others."""
    number = np.zeros(len(positions), np.int64)
    for axis in range(3):
        column = np.floor((positions[:, axis] - low[axis]) / side)
        number = (number << 21) | (np.clip(column, -1.0, 2.0**20).astype(np.int64) & 0x1FFFFF)
    return number
