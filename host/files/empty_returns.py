"""Returns that found nothing: points at exactly 0, 0, 0, where a file has several of them.

Scanners and depth cameras write a row for every direction. One that found nothing is all zeros.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .wanted import EMPTY, Wanted

__all__ = ["EMPTY_NOTE", "Empty", "check_seen", "empty_of", "seen_rows"]

EMPTY_NOTE = (
    "points at exactly 0, 0, 0 are left out, as returns that found nothing; see --keep empty"
)


class Empty(Enum):
    """Points at exactly 0, 0, 0 that are left out."""

    KEPT = "none"
    SEVERAL = "all, if there are several"
    ALL = "all, as the file has several"


def empty_of(wanted: Wanted) -> Empty:
    """Return which points at exactly 0, 0, 0 are left out of a file that is read as a whole."""
    return Empty.KEPT if EMPTY in wanted.keep else Empty.SEVERAL


def seen_rows(
    positions: Sequence[npt.NDArray[Any]], empty: Empty = Empty.SEVERAL
) -> npt.NDArray[np.bool_] | None:
    """Return which points are drawn; None: all.

    Parameters
    ----------
    positions
        x, y and z as the file has them, before a scan's pose is applied: shape (n,) each.
    empty
        Which points at exactly 0, 0, 0 are left out.
    """
    if empty is Empty.KEPT or len(positions) != 3:
        return None
    zero: npt.NDArray[np.bool_] = positions[0] == 0
    if np.count_nonzero(zero) <= (empty is Empty.SEVERAL):
        return None
    for column in positions[1:]:
        zero = zero & (column == 0)
    found = int(np.count_nonzero(zero))
    if found <= (empty is Empty.SEVERAL):
        return None
    return ~zero


def check_seen(seen: npt.NDArray[np.bool_]) -> None:
    """Raise ``InputError`` if no point of a file is drawn."""
    if not seen.any():
        raise InputError(f"has no points but {len(seen):,} at exactly 0, 0, 0; see --keep empty")
