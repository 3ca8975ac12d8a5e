"""Rows of a binary PLY element that has lists, such as faces."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .ply_header import Element

__all__ = ["list_rows"]

CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
"""Letters of ``struct`` for numpy's types."""

_Bytes = npt.NDArray[np.uint8]


def list_rows(
    data: _Bytes, start: int, element: Element, order: str, wanted: bool
) -> tuple[Any, int]:
    """Return the scalars of an element's rows if they are wanted, and the byte behind the last row.

    Rows are mostly alike, as those of triangles are: then all are checked at once against the
    lengths of the first. Else they are walked one by one.

    Raises
    ------
    InputError
        If the data end before the rows do, or a list has a negative length.
    """
    if not element.count:
        return np.empty(0, _uniform(element, order, {})), start
    try:
        steps = _steps(element, order)
        lengths, _ = _walk(data, start, steps, None)
        kind = _uniform(element, order, lengths)
        end = start + element.count * kind.itemsize
        if end <= len(data):
            rows = data[start:end].view(kind)
            if all(np.all(rows[f"#{name}"] == length) for name, length in lengths.items()):
                return rows, end
        scalars = _uniform(element, order, dict.fromkeys(lengths, 0))
        table = np.zeros(element.count if wanted else 0, scalars)
        for number in range(element.count):
            _, start = _walk(data, start, steps, table[number] if wanted else None)
    except (struct.error, ValueError):
        raise InputError(
            f"ends inside element {element.name}; is it damaged, or truncated?"
        ) from None
    return table, start


def _uniform(element: Element, order: str, lengths: dict[str, int]) -> np.dtype[Any]:
    """Return the type of a row whose lists have known lengths; ``#name`` is a list's length."""
    fields: list[Any] = []
    for item in element.properties:
        if item.length is None:
            fields.append((item.name, order + item.kind))
        else:
            fields.append((f"#{item.name}", order + item.length))
            fields.append((item.name, order + item.kind, (lengths.get(item.name, 0),)))
    return np.dtype(fields)


def _steps(element: Element, order: str) -> list[tuple[str, struct.Struct, int]]:
    """Return for each property its name, how its value or length is read, and an item's bytes."""
    return [
        (
            item.name,
            struct.Struct(order + CODES[item.length or item.kind]),
            0 if item.length is None else np.dtype(item.kind).itemsize,
        )
        for item in element.properties
    ]


def _walk(
    data: _Bytes, start: int, steps: list[tuple[str, struct.Struct, int]], row: Any
) -> tuple[dict[str, int], int]:
    """Return the lengths of a row's lists and the byte behind it; copy its scalars to ``row``."""
    lengths = {}
    for name, reader, item in steps:
        (value,) = reader.unpack_from(data, start)
        start += reader.size
        if item:
            if value < 0:
                raise ValueError
            lengths[name] = value
            start += value * item
        elif row is not None:
            row[name] = value
    if start > len(data):
        raise ValueError
    return lengths, start
