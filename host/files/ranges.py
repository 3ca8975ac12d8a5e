"""The range of a column's values."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["Range", "range_of"]

Range = tuple[float | None, float | None, int]
"""The least and the greatest finite value, None without any, and how many are not finite."""


def range_of(column: Any) -> Range:
    """Return the least and the greatest finite value of a column, and how many are not finite."""
    values = np.asarray(column)
    if not values.size:
        return None, None, 0
    low, high = values.min(), values.max()
    if values.dtype.kind == "f" and not (np.isfinite(low) and np.isfinite(high)):
        finite = values[np.isfinite(values)]
        if not finite.size:
            return None, None, values.size
        return float(finite.min()), float(finite.max()), values.size - finite.size
    whole = values.dtype.kind in "iu"
    return (int(low), int(high), 0) if whole else (float(low), float(high), 0)
