"""Prefetching in compiled code: asks for memory some turns of a loop before it is used.

Points that a view shows lie scattered over a large index, so each would wait for memory by itself.
A group of eight points takes 90 ns to read then, and 15 ns if it was asked for 16 groups before.
"""

from __future__ import annotations

from typing import Any

import numba as nb
from llvmlite import ir
from numba.core import cgutils
from numba.extending import intrinsic

__all__ = ["AHEAD", "prefetch"]

AHEAD = 16
"""Turns of a loop before the one that uses the memory."""


@intrinsic
def prefetch(_: Any, array: Any, byte: Any) -> Any:
    """Ask for the line of the cache that holds a byte of a C-contiguous array.

    The byte may lie beyond the array: nothing is read then.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        pointer, whole = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [pointer, whole, whole, whole])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        place = builder.gep(builder.bitcast(data, pointer), [arguments[1]])
        # To be read, kept in all caches, and data.
        builder.call(function, [place, whole(0), whole(3), whole(1)])
        return context.get_dummy_value()

    return nb.void(array, nb.int64), code
