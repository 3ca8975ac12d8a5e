"""A cloud's points along Morton's curve: one order for searches of neighbours and for the index."""

from __future__ import annotations

from typing import Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

from .curve import spread_bits

__all__ = ["Curve", "sort_along_curve"]

MOST_LEVELS = 20
"""Levels of the octree: its smallest cube is a millionth of the cloud."""

SAMPLED = 4096
"""Points that tell where the bulk of a cloud lies."""

TAIL = 50
"""One in so many points on either side may lie outside the bulk."""

_Floats = npt.NDArray[np.float64]


class Curve(NamedTuple):
    """Points along the curve through a cube about nearly all of them.

    Parameters
    ----------
    order
        The points, as indices: shape (n,), int32. Points of one smallest cube keep their order.
    keys
        Their positions along the curve, ascending: shape (n,), int64.
    levels
        Levels of the octree: a key has three bits for each.
    low, unit
        The cube's low corner and its side.
    """

    order: npt.NDArray[np.int32]
    keys: npt.NDArray[np.int64]
    levels: int
    low: _Floats
    unit: float


def sort_along_curve(positions: _Floats) -> Curve:
    """Return the points of a cloud along Morton's curve.

    Parameters
    ----------
    positions
        Shape (n, 3), float64, finite.
    """
    positions = np.ascontiguousarray(positions, np.float64)
    count = len(positions)
    if not count:
        return Curve(np.empty(0, np.int32), np.empty(0, np.int64), 0, np.zeros(3), 1.0)
    low, unit = _bulk(positions)
    number_bits = max((count - 1).bit_length(), 1)
    levels = min((63 - number_bits) // 3, MOST_LEVELS)
    keys = np.empty(count, np.int64)
    _set_keys(positions, low, unit, levels, number_bits, keys)
    # Each key ends in its point's number, so any sort gives the same order.
    keys.sort()
    order = np.empty(count, np.int32)
    _split_keys(number_bits, order, keys)
    return Curve(order, keys, levels, low, unit)


def _bulk(positions: _Floats) -> tuple[_Floats, float]:
    """Return the low corner and the extent of a cube about nearly all points.

    A few points far away must not make all others share a cube. They count in the cube's outermost
    cells.
    """
    sampled = np.sort(positions[:: -(-len(positions) // SAMPLED)], axis=0)
    tail = len(sampled) // TAIL
    low, high = sampled[tail], sampled[len(sampled) - 1 - tail]
    # Half of the range again, as the tails of the bulk belong to it.
    margin = 0.5 * (high - low).max()
    least, most = limits(positions)
    if margin > 0.0:
        least, most = np.maximum(least, low - margin), np.minimum(most, high + margin)
    extent = float((most - least).max())
    return least, extent if extent > 0.0 else 1.0


@cached_njit()
def limits(positions: Any) -> tuple[Any, Any]:
    """Return the least and greatest coordinates (numpy takes four times as long by columns)."""
    low, high = positions[0].copy(), positions[0].copy()
    for i in range(len(positions)):
        for axis in range(3):
            value = positions[i, axis]
            low[axis] = value if value < low[axis] else low[axis]
            high[axis] = value if value > high[axis] else high[axis]
    return low, high


@cached_njit(parallel=True, error_model="numpy")
def _set_keys(
    positions: Any, low: Any, unit: float, levels: int, number_bits: int, keys: Any
) -> None:
    """Set each point's position along the curve, with its number in the lower bits."""
    most = float((1 << levels) - 1)
    for i in nb.prange(len(positions)):
        key = 0
        for axis in range(3):
            share = (positions[i, axis] - low[axis]) / unit * (most + 1.0)
            key |= spread_bits(int(min(max(share, 0.0), most))) << axis
        keys[i] = key << number_bits | i


@cached_njit(parallel=True)
def _split_keys(number_bits: int, order: Any, keys: Any) -> None:
    """Split each key into its point's number and its position along the curve."""
    mask = (1 << number_bits) - 1
    for i in nb.prange(len(keys)):
        order[i] = keys[i] & mask
        keys[i] >>= number_bits
