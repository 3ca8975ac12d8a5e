"""The count of a binary STL file, checked against its size."""

from __future__ import annotations

import struct

from splatline.contract.errors import InputError

from .source import Source

__all__ = ["check_stl"]

HEAD = 80
"""Bytes before the count: any text."""

TRIANGLE = 50
"""Bytes of a triangle: twelve floats and an attribute."""

TEXT = 4096
"""Bytes in which a file of text has its first ``facet``, whatever its name is."""


def check_stl(source: Source) -> None:
    """Raise ``InputError`` if a binary file has another size than its count of triangles says."""
    source.stream.seek(0)
    start = source.stream.read(TEXT)
    if start.lstrip()[:5].lower() == b"solid" and (b"facet" in start.lower() or 0 not in start):
        return
    if len(start) < HEAD + 4:
        raise InputError("cannot be read as STL: it ends inside its header")
    (count,) = struct.unpack_from("<I", start, HEAD)
    held, rest = divmod(source.size - HEAD - 4, TRIANGLE)
    if count > held:
        raise InputError(
            f"cannot be read as STL: ends after {held:,} of its {count:,} triangles;"
            " is it damaged, or truncated?"
        )
    if count < held or rest:
        behind = source.size - HEAD - 4 - TRIANGLE * count
        raise InputError(
            f"cannot be read as STL: has {behind:,} bytes behind its {count:,} triangles;"
            " is it damaged?"
        )
