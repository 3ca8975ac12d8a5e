"""PCD files: ASCII, binary and compressed."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, bytes_left, find_meaning, gather
from .numbers import as_declared, lines_of, load_rows
from .pcd_header import Header, read_header
from .source import Source

__all__ = ["read_pcd"]

SHORTEST_COPY = 100
"""More bytes than one byte of LZF can stand for: three bytes copy at most 264."""

_Table = Mapping[str, Any]


def read_pcd(source: Source) -> Columns:
    """Return the points of a PCD file.

    A packed colour, the field ``rgb`` or ``rgba``, is unpacked. Otherwise colours come from three
    fields, as in the other formats. A field with a COUNT of 3 is a vector.

    Raises
    ------
    InputError
        If it has no x, y and z, is damaged, or ends early.
    """
    header = read_header(source)
    names = [field.name for field in header.fields if field.name.split()[0] != "_"]  # padding
    widths = {field.name: field.count for field in header.fields}
    meaning = find_meaning(names, widths, source.wanted)
    if meaning is None:
        raise InputError(f"has no fields x, y and z; it has {', '.join(names)[:80] or 'none'}")
    source.stream.seek(header.size)
    table: _Table
    left = 0
    if not header.points:
        raise InputError("has no points")
    if header.form == "ascii":
        table = _from_text(source, header)
    elif header.form == "binary":
        rows = source.read(header.points * header.row).view(header.dtype)
        table = {name: rows[name] for name in names}
        left = source.size - header.size - rows.nbytes
    else:
        table = _decompressed(source, header)
    return gather(table, meaning, bytes_left(left))


def _from_text(source: Source, header: Header) -> _Table:
    """Return the fields of ASCII data; integers and packed colours get their own type."""
    width = sum(field.count for field in header.fields)
    lines = partial(lines_of, source, header.size)
    rows = load_rows(lines, range(width), width=width, limit=header.points, exact=False)
    if len(rows) < header.points:
        raise InputError(f"ends after {len(rows)} of its {header.points} points; it is truncated")
    table = {}
    column = 0
    for field in header.fields:
        part = rows[:, column : column + field.count]
        column += field.count
        if field.kind == np.float32 and field.name.lower() in ("rgb", "rgba"):
            part = part.astype(np.float32)  # whose bits are the colour
        part = as_declared(part, field.kind)
        table[field.name] = part[:, 0] if field.count == 1 else part
    return table


def _decompressed(source: Source, header: Header) -> _Table:
    """Return the fields of compressed data, which lie one behind the other."""
    import lzf

    sizes = np.frombuffer(source.stream.read(8), "<u4")
    left = source.size - header.size - 8
    if len(sizes) < 2 or int(sizes[0]) > left:
        raise InputError("ends inside its compressed points; it is truncated")
    packed, unpacked = map(int, sizes)
    wanted = header.points * header.row
    if unpacked != wanted or unpacked > SHORTEST_COPY * packed:
        raise InputError(
            f"promises {header.points} points of {header.row} bytes, but holds {unpacked} bytes"
            f" in {packed}; is it damaged?"
        )
    points = source.read(packed)
    points.flags.writeable = False  # which lzf insists on
    data = lzf.decompress(points, unpacked)
    if data is None or len(data) != unpacked:
        raise InputError("cannot be decompressed; is it damaged?")
    table: dict[str, npt.NDArray[Any]] = {}
    start = 0
    for field in header.fields:
        values = np.frombuffer(data, field.kind, header.points * field.count, start)
        start += values.nbytes
        table[field.name] = values if field.count == 1 else values.reshape(-1, field.count)
    return table
