"""Plane words in whole arrays, for checks: slow, and written apart from golden's loops."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.config import BLOCK, ROWS, EngineConfig
from splatline.contract.fields import Field
from splatline.contract.plane import LOW_BITS, SHIFTS, SUM_FRACTION, Z_FRACTION

__all__ = ["decode_planes", "depth_at", "plane_rows"]

_Ints = npt.NDArray[np.int64]

PLANE_WORD = np.dtype(
    [
        *((name, np.int64) for name in ("mode", "x", "slope_x", "slope_y", "scale", "z")),
        *((name, np.int64, (ROWS,)) for name in ("first", "last", "side_first", "side_last")),
        *((name, np.bool_) for name in ("raised", "first_out", "last_out", "control", "end")),
    ]
)
"""The fields of a decoded plane word; slopes are signed and not yet shifted."""


def decode_planes(codewords: npt.NDArray[np.uint64], config: EngineConfig) -> npt.NDArray[Any]:
    """Decode plane words into their fields.

    Parameters
    ----------
    codewords
        Low and high half: shape (n, 2), uint64.
    config
        An engine with planes.

    Returns
    -------
    numpy.ndarray
        Shape (n,), of ``PLANE_WORD``.
    """
    fields = np.empty(len(codewords), PLANE_WORD)

    def take(field: Field) -> _Ints:
        half, lsb = divmod(field.lsb, LOW_BITS)
        return (codewords[:, half] >> np.uint64(lsb) & np.uint64(field.mask)).astype(np.int64)

    for name in ("mode", "x", "scale", "z", "raised"):
        fields[name] = take(getattr(config, name))
    for name in ("slope_x", "slope_y"):
        half = 1 << config.slope_bits - 1
        fields[name] = (take(getattr(config, name)) ^ half) - half
    for row in range(ROWS):
        fields["first"][:, row], fields["last"][:, row] = map(
            take, (config.first(row), config.last(row))
        )
        fields["side_first"][:, row] = take(config.side(row, 0))
        fields["side_last"][:, row] = take(config.side(row, 1))
    fields["first_out"], fields["last_out"] = (take(config.outwards(end)) for end in (0, 1))
    empty = (fields["first"] > fields["last"]).all(axis=1)
    fields["control"] = empty & (fields["mode"] == 1)
    fields["end"] = fields["control"] & (take(config.control_end) == 1)
    return fields


def plane_rows(fields: npt.NDArray[Any]) -> tuple[_Ints, _Ints]:
    """Return first and last column of the eight rows of elements; an empty row has first > last.

    Returns
    -------
    first, last
        Shape (n, 8).
    """
    count = len(fields)
    firsts, lasts = np.ones((count, BLOCK), np.int64), np.zeros((count, BLOCK), np.int64)
    firsts[:, :ROWS], lasts[:, :ROWS] = fields["first"], fields["last"]
    here = np.arange(count)
    for k in range(ROWS):
        first, last = fields["first"][:, k], fields["last"][:, k]
        rotated = (fields["mode"] == 0) & (first <= last)
        if k == ROWS - 1:
            rotated &= ~fields["raised"]
        below = BLOCK - 1 - fields["raised"].astype(np.int64) - k
        moved_first = np.where(fields["first_out"], -1, 1) * fields["side_first"][:, k]
        moved_last = np.where(fields["last_out"], 1, -1) * fields["side_last"][:, k]
        at = here[rotated], below[rotated]
        firsts[at] = np.clip(BLOCK - 1 - last + moved_first, 0, BLOCK - 1)[rotated]
        lasts[at] = np.clip(BLOCK - 1 - first + moved_last, 0, BLOCK - 1)[rotated]
    return firsts, lasts


def depth_at(fields: npt.NDArray[Any], row: int, column: int, config: EngineConfig) -> _Ints:
    """Return the depth of elements at a row and a column of their blocks: shape (n,).

    A pixel at the background's depth is not drawn. The column may be one past the block, as in
    words without planes; no plane word has it.
    """
    shift = np.array(SHIFTS)[fields["scale"]]
    total = fields["z"] << SUM_FRACTION - Z_FRACTION
    total = total + (column * fields["slope_x"] + row * fields["slope_y"] << shift)
    depth: _Ints = np.clip(total >> SUM_FRACTION, 0, config.background_depth)
    return depth
