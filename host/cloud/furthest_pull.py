"""The neighbour whose pull reaches furthest in a direction, found by vector instructions."""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
from llvmlite import ir
from numba.extending import intrinsic

from .pulls import NEAREST

__all__ = ["NONE", "furthest_pull"]

NONE = -1
"""Number of no neighbour: its pull is 0."""

INDEX_BITS = 11
"""Low bits of a float32 that hold a neighbour's number."""


@intrinsic
def _larger(_: Any, best: Any, value: Any, number: Any) -> Any:
    """Return the larger of ``best`` and a float32's bits with a number in the low ones.

    Positive floats are ordered as their bits are, so LLVM makes a vector maximum of this. It makes
    none of a float and an index that are chosen together.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(32)
        bits = builder.bitcast(arguments[1], whole)
        mask = ir.Constant(whole, -(1 << INDEX_BITS))
        tagged = builder.or_(builder.and_(bits, mask), builder.trunc(arguments[2], whole))
        is_larger = builder.icmp_signed(">", tagged, arguments[0])
        return builder.select(is_larger, tagged, arguments[0])

    return nb.int32(nb.int32, nb.float32, nb.int64), code


@intrinsic
def _as_float(_: Any, bits: Any) -> Any:
    """Return the float32 that has these bits."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.FloatType())

    return nb.float32(nb.int32), code


@intrinsic
def _number(_: Any, value: Any) -> Any:
    """Return the number in a float32's low bits."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        whole = ir.IntType(32)
        bits = builder.bitcast(arguments[0], whole)
        low = builder.and_(bits, ir.Constant(whole, (1 << INDEX_BITS) - 1))
        return builder.zext(low, ir.IntType(64))

    return nb.int64(nb.float32), code


@nb.njit(error_model="numpy")
def furthest_pull(right: Any, up: Any, count: int, x: float, y: float) -> int:
    """Return the number of the pull that reaches furthest in a direction, or ``NONE``."""
    best = np.int32(0)
    for c in range(count):
        best = _larger(best, right[c] * x + up[c] * y, c)
    furthest = _as_float(best)
    return _number(furthest) if furthest > NEAREST else NONE
