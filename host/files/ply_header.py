"""The header of a PLY file, and what it promises."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from splatline.contract.errors import InputError

from .columns import unique_names
from .source import Source

__all__ = ["Element", "Header", "Property", "read_header"]

LONGEST = 1 << 20
"""Bytes of the longest header that is read."""

TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}

ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}

_END = re.compile(rb"(?:^|[\r\n])end_header[ \t]*(\r\n|\n|\r)")


@dataclass(frozen=True)
class Property:
    """A column: its name, its type, and the type of its length if it is a list."""

    name: str
    kind: str
    length: str | None = None


@dataclass(frozen=True)
class Element:
    """A table: its name, its number of rows, and its columns."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def scalars(self) -> list[str]:
        """Names of the properties that have one value a row."""
        return [item.name for item in self.properties if item.length is None]

    @property
    def has_lists(self) -> bool:
        """Whether its rows differ in length."""
        return any(item.length is not None for item in self.properties)

    @property
    def least_bytes(self) -> int:
        """Bytes of the shortest binary row, in which lists are empty."""
        return sum(np.dtype(item.length or item.kind).itemsize for item in self.properties)

    def dtype(self, order: str) -> np.dtype[Any]:
        """Return the type of a binary row without lists."""
        return np.dtype([(item.name, order + item.kind) for item in self.properties])


@dataclass(frozen=True)
class Header:
    """Header of the file, before the data.

    Parameters
    ----------
    order
        Byte order, ``<`` or ``>``; None if the data are text.
    elements
        The tables that have columns, in order.
    size
        Bytes of the header.
    """

    order: str | None
    elements: tuple[Element, ...]
    size: int


def read_header(source: Source) -> Header:
    """Return the header; the file is large enough for what it promises.

    A property that comes twice gets another name. Comments may be in any encoding.

    Raises
    ------
    InputError
        If it is no header, or promises more rows than the file has bytes for.
    """
    head = source.stream.read(LONGEST).removeprefix(b"\xef\xbb\xbf")
    if not re.match(rb"ply\s", head):
        raise InputError("cannot be read as PLY: it does not begin with the word ply")
    end = _END.search(head)
    if end is None:
        raise InputError("cannot be read as PLY: its header has no end; is it damaged?")
    line_end = end[1]
    if line_end == b"\r\n" and re.match(rb"ply[ \t]*\r(?!\n)", head):
        line_end = b"\r"  # the line feed is data
    mark = 3 if source.stream.seek(0) == 0 and source.stream.read(3) == b"\xef\xbb\xbf" else 0
    size = mark + end.start(1) + len(line_end)
    header = _parse(head[: end.start(1)].decode("latin-1"), size)
    _check_size(header, source.size - size)
    return header


def _parse(text: str, size: int) -> Header:
    """Return the header that its lines describe."""
    found = ""
    tables: list[tuple[str, int, list[Property]]] = []
    for line in re.split(r"[\r\n]+", text)[1:]:
        words = line.split()
        if not words or words[0] in ("comment", "obj_info", "end_header"):
            continue
        try:
            if words[0] == "format" and words[1] in ORDERS:
                found = words[1]
            elif words[0] == "element" and int(words[2]) >= 0:
                tables.append((words[1], int(words[2]), []))
            elif words[0] == "property":
                tables[-1][2].append(_property(words))
            else:
                raise ValueError
        except (IndexError, KeyError, ValueError):
            raise InputError(
                f"cannot be read as PLY: its header has the line {line.strip()[:60]!r};"
                " is it damaged?"
            ) from None
    if not found:
        raise InputError("cannot be read as PLY: its header names no format; is it damaged?")
    elements = []
    for name, count, properties in tables:
        names = unique_names([item.name for item in properties])
        renamed = [
            Property(other, item.kind, item.length)
            for other, item in zip(names, properties, strict=True)
        ]
        if properties:
            elements.append(Element(name, count, tuple(renamed)))
    return Header(ORDERS[found], tuple(elements), size)


def _property(words: list[str]) -> Property:
    """Return the property of a header's line."""
    if words[1] == "list":
        length = TYPES[words[2]]
        if length[0] == "f":
            raise ValueError
        return Property(" ".join(words[4:]) or words[4], TYPES[words[3]], length)
    return Property(" ".join(words[2:]) or words[2], TYPES[words[1]])


def _check_size(header: Header, size: int) -> None:
    """Raise ``InputError`` if the shortest rows would be longer than the file."""
    for element in header.elements:
        # A value of a text takes a digit and what separates it from the next.
        least = 2 * len(element.properties) if header.order is None else element.least_bytes
        if element.count * least > size + 1:
            fits = max(0, size) // least
            raise InputError(
                f"promises {element.count} rows of element {element.name}, but there are bytes for"
                f" {fits}; is it damaged, or truncated?"
            )
        size -= element.count * least
