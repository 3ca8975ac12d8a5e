"""The header of a PCD file, and what it promises."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from splatline.contract.errors import InputError

from .columns import unique_names
from .source import Source

__all__ = ["Field", "Header", "read_header"]

LONGEST = 1 << 20
"""Bytes of the longest header that is read."""

TYPES = {"F": "f", "U": "u", "I": "i"}

FORMATS = ("ascii", "binary", "binary_compressed")

_KEYS = ("VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "POINTS")


@dataclass(frozen=True)
class Field:
    """A column: its name, the type of its values, and how many a point has."""

    name: str
    kind: np.dtype[Any]
    count: int

    @property
    def size(self) -> int:
        """Bytes a point."""
        return self.kind.itemsize * self.count


@dataclass(frozen=True)
class Header:
    """Header of the file, before the data.

    Parameters
    ----------
    fields
        The columns that have values; padding is one of them.
    points
        Number of points.
    form
        ``ascii``, ``binary`` or ``binary_compressed``.
    size
        Bytes of the header.
    """

    fields: tuple[Field, ...]
    points: int
    form: str
    size: int

    @property
    def row(self) -> int:
        """Bytes of a point in binary data."""
        return sum(item.size for item in self.fields)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of a point in binary data."""
        return np.dtype(
            [
                (item.name, item.kind) if item.count == 1 else (item.name, item.kind, (item.count,))
                for item in self.fields
            ]
        )


def read_header(source: Source) -> Header:
    """Return the header. Comments may be in any encoding, and lines of unknown names are skipped.

    Names may have brackets. Without COUNT every field has one value; a field with none is left out.

    Raises
    ------
    InputError
        If it is no header, or promises more points than the file has bytes for.
    """
    lines: dict[str, list[str]] = {}
    size = 0
    source.stream.seek(0)
    while "DATA" not in lines:
        raw = source.stream.readline(LONGEST)
        size += len(raw)
        if not raw or size > LONGEST:
            raise InputError("cannot be read as PCD: its header has no line DATA; is it damaged?")
        words = raw.decode("latin-1").removeprefix("\xef\xbb\xbf").split()
        if words and not words[0].startswith("#"):
            lines.setdefault(words[0].upper(), words[1:])
    if not any(key in lines for key in _KEYS):
        raise InputError("cannot be read as PCD: it has no header; is it damaged?")
    header = _parse(lines, size)
    _check_size(header, source.size - size)
    return header


def _parse(lines: Mapping[str, list[str]], size: int) -> Header:
    """Return the header that its lines describe."""
    form = lines["DATA"][0].lower() if lines["DATA"] else ""
    if form not in FORMATS:
        raise InputError(
            f"cannot be read as PCD: its DATA is {form[:40]!r}, none of {', '.join(FORMATS)}"
        )
    names = lines.get("FIELDS") or lines.get("COLUMNS") or []
    sizes, types = lines.get("SIZE"), lines.get("TYPE")
    if form == "ascii":  # in which neither matters, but for packed colours
        sizes, types = sizes or ["4"] * len(names), types or ["F"] * len(names)
    if sizes is None or types is None:
        raise InputError("cannot be read as PCD: its header has no SIZE or TYPE; is it damaged?")
    if len(names) > len(types):  # a name with a blank, such as Illuminance (PCV)
        names = [name for name in names if name[0] not in "([" or name[-1] not in ")]"]
    counts = lines.get("COUNT") or ["1"] * len(names)
    if not len(names) == len(sizes) == len(types) == len(counts):
        raise InputError(
            f"cannot be read as PCD: its header has {len(names)} FIELDS, but {len(sizes)} SIZE,"
            f" {len(types)} TYPE and {len(counts)} COUNT; is it damaged?"
        )
    fields = []
    for name, width, letter, count in zip(unique_names(names), sizes, types, counts, strict=True):
        try:
            kind = np.dtype(f"<{TYPES[letter.upper()]}{int(width)}")
            field = Field(name, kind, int(count))
        except (KeyError, TypeError, ValueError):
            raise InputError(
                f"cannot be read as PCD: its field {name[:40]} has TYPE {letter[:9]},"
                f" SIZE {width[:9]} and COUNT {count[:20]}; is it damaged?"
            ) from None
        if field.count > 0:
            fields.append(field)
        elif field.count < 0:
            raise InputError(f"cannot be read as PCD: its field {name[:40]} has a COUNT below 0")
    return Header(tuple(fields), _points(lines), form, size)


def _points(lines: Mapping[str, list[str]]) -> int:
    """Return the number of points: POINTS, or WIDTH times HEIGHT."""
    try:
        if "POINTS" in lines:
            points = int(lines["POINTS"][0])
        else:
            points = int(lines["WIDTH"][0]) * int(lines.get("HEIGHT", ["1"])[0])
    except (IndexError, KeyError, ValueError):
        points = -1
    if points < 0:
        raise InputError(
            "cannot be read as PCD: its header does not say how many points there are;"
            " is it damaged?"
        )
    return points


def _check_size(header: Header, size: int) -> None:
    """Raise ``InputError`` if the file is too short for the points that the header promises."""
    if header.form == "binary_compressed" or not header.points:
        return
    least = header.row
    if header.form == "ascii":  # a value takes a digit and what separates it from the next
        least = 2 * sum(item.count for item in header.fields)
    if header.points * least > size + (header.form == "ascii"):
        fits = max(0, size) // least
        raise InputError(
            f"ends after {fits} of its {header.points} points; it is truncated"
            if header.form == "binary"
            else f"promises {header.points} points of {least // 2} values, but has {size} bytes;"
            " is it damaged, or truncated?"
        )
