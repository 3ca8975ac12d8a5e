"""Projection: from points in space to splats on the image, culled and shaded on the way."""

from __future__ import annotations

import dataclasses

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.deal import deal

from .block_index import BLOCK_POINTS, Index
from .cull import Camera, cull_blocks
from .look_over import Blocks, Points, look_over
from .point_records import views
from .project_loop import WINDOW, Look, Slots, project_blocks
from .skips import DEFAULT_SKIPS, REASONS, SKIPS
from .splats import SPLAT, Splats
from .view import View

__all__ = ["project"]

CHUNKS = 64
"""Parts of the work, the same on every machine so that results do not depend on it."""


def project(
    index: Index,
    view: View,
    shades: npt.NDArray[np.uint32],
    material_shift: int,
    skips: frozenset[str] = DEFAULT_SKIPS,
    cover: float = 1.0,
) -> Splats:
    """Project a cloud's discs and leave out those that the view does not show.

    A disc with centre p and unit normal n, in camera coordinates, holds the points q = p + d with
    n . d = 0 and |d| <= R. With a = p_x / p_z, b = p_y / p_z, and s, t the offset on the image
    from the centre times p_z / focal, the plane gives d_z = -(n'x s + n'y t), where
    n' = (n_x, n_y) / (n . (a, b, 1)). To first order |d|^2 = s^2 + t^2 + d_z^2: the paper's
    ellipse of radius R focal / p_z pixels.

    Parameters
    ----------
    index
        The points.
    view
        The view.
    shades
        DIFFUSE and SPECULAR by quantised normal; see ``shade_bits``.
    material_shift
        Lowest bit of MATERIAL, counted from DIFFUSE's.
    skips
        Reasons to leave points out; see ``SKIPS``. Points nearer than the view's near distance are
        always left out.
    cover
        How far small discs are trimmed; see ``trim``. 1: not.

    Returns
    -------
    Splats
        In the index's order.
    """
    camera = Camera.of(view, cover)
    rules = np.array([False, *(name in skips for name in SKIPS)])
    status = np.empty(len(index.bounds), np.uint8)
    cull_blocks(index.bounds, camera, rules, status)
    sizes = np.full(len(status), BLOCK_POINTS)
    sizes[-1:] = len(index) - BLOCK_POINTS * (len(status) - 1)
    tally = np.bincount(status, weights=sizes, minlength=1 + len(SKIPS)).astype(np.int64)

    visible = np.flatnonzero(status == 0)
    cuts = np.linspace(0, len(visible), CHUNKS + 1).astype(np.int64)
    turns = deal(np.arange(CHUNKS))
    kept = np.empty(BLOCK_POINTS * len(visible), np.int32)
    blocks = Blocks(index.bounds, visible, cuts, turns, kept)
    reasons = np.zeros((CHUNKS, 1 + len(SKIPS)), np.int64)
    look_over(Points(len(index), index.discs, index.groups), blocks, camera, rules, reasons)

    starts = np.concatenate([[0], np.cumsum(reasons[:, 0])])
    stops = np.empty(CHUNKS, np.int64)
    limits = np.empty((CHUNKS, 2))
    splats = Splats(np.empty(starts[-1], SPLAT), starts[:-1], stops, limits[:, 0], (0.0, 0.0), {})
    nearest = np.full((nb.get_num_threads(), WINDOW * WINDOW), -1, np.int32)
    project_blocks(
        views(index.points),
        blocks,
        camera,
        Look(rules, shades, material_shift),
        Slots(*splats.views(), splats.starts, stops, limits, reasons, nearest),
    )
    tally += reasons.sum(axis=0)
    low, high = float(limits[:, 0].min()), float(limits[:, 1].max())
    return dataclasses.replace(
        splats,
        depth_range=(low, high) if len(splats) else (0.0, 0.0),
        culled={name: int(tally[reason]) for name, reason in REASONS.items()},
    )
