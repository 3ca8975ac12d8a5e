"""Gaussian splats, as 3D Gaussian Splatting writes them to PLY, as discs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, find_meaning, gather
from .empty_returns import Empty
from .wanted import USUAL, Wanted

__all__ = ["are_gaussians", "gaussian_columns"]

HARMONICS = ("f_dc_0", "f_dc_1", "f_dc_2")
OPACITY = ("opacity",)
SCALES = ("scale_0", "scale_1", "scale_2")
ROTATION = ("rot_0", "rot_1", "rot_2", "rot_3")

OPAQUE = 0.3
"""Least opacity of a splat that is drawn. Discs are opaque. Two splats of this opacity, one before
the other, hide half of what is behind them: 1 - 0.7^2 = 0.51."""

ROUND = 0.7
"""A splat is round if its smallest standard deviation is more than this share of the middle one.
Its shape tells no normal."""

LARGEST = 1e100
"""Radii beyond this count as not finite: their squares would not be."""


def are_gaussians(names: Sequence[str]) -> bool:
    """Return whether columns are those of Gaussian splats."""
    return {*HARMONICS, *OPACITY, *SCALES, *ROTATION} <= {*names}


def gaussian_columns(
    table: Mapping[str, Any],
    names: Sequence[str],
    notes: Sequence[str] = (),
    wanted: Wanted = USUAL,
) -> Columns:
    """Return discs for Gaussian splats.

    - Opacity is the logistic function of the file's number. Splats below ``OPAQUE`` are left out.
    - The normal is the axis of the smallest scale; its sign means nothing. That of a round splat
      is missing, as of a point without one.
    - The disc has the area over which the Gaussian's opacity adds up: with standard deviations s
      and t along the two larger axes and opacity a, the integral of
      ``a exp(-(x/s)^2/2 - (y/t)^2/2)`` is ``2 pi a s t``, so the radius is ``sqrt(2 a s t)``. A
      scale in the file is the logarithm of a standard deviation.

    Parameters
    ----------
    table
        The columns that ``are_gaussians`` asks for, and the positions: shape (n,) each.
    names
        All columns of the file.
    notes
        What is known of the file already.
    wanted
        What colours a splat, and whether ranges are wanted: those of the splats that are drawn.

    Raises
    ------
    InputError
        If all splats are left out, or there is no column of what is to colour them.
    """
    opacity = 1.0 / (1.0 + np.exp(-_stack(table, OPACITY)[:, 0]))
    deviations = np.exp(_stack(table, SCALES))
    order = np.argsort(deviations, axis=1)
    larger = np.take_along_axis(deviations, order[:, 1:], axis=1)
    radii = np.sqrt(2.0 * opacity * larger[:, 0] * larger[:, 1])
    seen = opacity >= OPAQUE
    kept = seen & (radii > 0.0) & (radii <= LARGEST)  # false for NaN
    if not kept.any():
        raise InputError(f"none of its {len(kept):,} splats has an opacity of {OPAQUE} and a size")
    meaning = find_meaning(names, wanted=wanted)
    assert meaning is not None
    meaning = replace(meaning, normals=(), empty=Empty.KEPT)  # their normals are 0
    rows = {name: np.asarray(table[name])[kept] for name in meaning.names}
    columns = gather(rows, meaning, notes)
    used = dict.fromkeys(OPACITY, "opacity") | dict.fromkeys(SCALES, "size")
    used |= dict.fromkeys(ROTATION, "orientation")
    used = columns.used | {
        name: f"{columns.used[name]}; {what}" if name in columns.used else what
        for name, what in used.items()
    }
    dropped = {"transparent": len(kept) - int(np.count_nonzero(seen))}
    if strange := int(np.count_nonzero(seen & ~kept)):
        dropped["without_size"] = strange
    normals = _axes(_stack(table, ROTATION)[kept], order[kept, 0])
    least = np.take_along_axis(deviations, order[:, :1], axis=1)[:, 0]
    is_round = (least > ROUND * larger[:, 0])[kept]
    normals[is_round] = 0.0
    if is_round.any():
        told = f"{np.count_nonzero(is_round):,} splats are round, so their normals are estimated"
        columns = replace(columns, notes=(*columns.notes, told))
    return replace(
        columns,
        normals=normals,
        used=used,
        ignored=tuple(name for name in names if name not in used),
        dropped=dropped,
        radii=radii[kept],
        two_sided=True,
    )


def _stack(table: Mapping[str, Any], names: Sequence[str]) -> npt.NDArray[np.float64]:
    """Return columns side by side: shape (n, columns)."""
    return np.stack([np.asarray(table[name], np.float64) for name in names], axis=-1)


def _axes(
    rotations: npt.NDArray[np.float64], number: npt.NDArray[np.intp]
) -> npt.NDArray[np.float64]:
    """Return one axis of each rotated splat: shape (n, 3), of any length.

    A quaternion w, x, y, z of any length rotates the axis ``e`` to the direction of
    ``(w^2 - u.u) e + 2 (u.e) u + 2 w (u x e)`` with ``u = (x, y, z)``.
    """
    real, vector = rotations[:, :1], rotations[:, 1:]
    axis = np.eye(3)[number]
    along = np.einsum("ij,ij->i", vector, axis)[:, np.newaxis]
    square = np.einsum("ij,ij->i", vector, vector)[:, np.newaxis]
    turned: npt.NDArray[np.float64] = (
        (real * real - square) * axis + 2.0 * along * vector + 2.0 * real * np.cross(vector, axis)
    )
    return turned
