"""The header of a LAS or LAZ file, and what it promises.

laspy's own header refuses LAS 1.0 and texts that are not UTF-8, and believes every count.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import unique_names
from .source import Source

__all__ = ["PROJECTION", "Extra", "LasHeader", "read_las_header"]

LENGTHS = (227, 227, 227, 235, 375, 375)
"""Bytes of the header of version 1.0, 1.1 and so on."""

LAST_FORMAT = 10

RECORD = 54
"""Bytes before the data of a variable length record."""

LASZIP = ("laszip encoded", 22204)
EXTRA_BYTES = ("LASF_Spec", 4)

EXTENDED = struct.Struct("<2x16sHQ32x")
"""Header of an extended record, which stands behind the points: user, number and length."""

PROJECTION = "LASF_Projection"
"""User of the records of the coordinate system, the only extended ones that are read."""

MOST_EXTENDED, LONGEST_EXTENDED = 1000, 1 << 20
"""Extended records that are looked at, and the longest one that is read, in bytes."""

DESCRIPTION = 192
"""Bytes that describe one field of extra bytes."""

KINDS = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
"""Types of extra bytes, from number 1; 10 more is an array of two, 20 more an array of three."""

SCALED, SHIFTED = 8, 16
"""Bits of a field's options: its scale and its offset count."""


@dataclass(frozen=True)
class Extra:
    """A field of the extra bytes at the end of a point.

    Parameters
    ----------
    name
        Its name; that of another field has a mark.
    kind
        Its type, little endian.
    start
        Its first byte, from the point's first.
    scale, shift
        Its value is ``scale`` times the number in the file, plus ``shift``.
    """

    name: str
    kind: str
    start: int
    scale: float = 1.0
    shift: float = 0.0


@dataclass(frozen=True)
class LasHeader:
    """Header of the file, before the points.

    Parameters
    ----------
    minor
        Version 1.``minor``.
    form
        Point data record format, 0 to 10.
    length
        Bytes of a point, at least those of its format.
    count
        Number of points, above 0.
    start
        First byte of the points.
    scales, offsets
        A coordinate is a scale times the integer in the file, plus an offset: shape (3,) each.
    low, high
        The least and the greatest coordinates, as the file says: shape (3,) each.
    extras
        Fields of the extra bytes that are described.
    laszip
        The record that tells how the points are compressed; empty if they are not.
    head
        The first bytes of the file, at least those of the shortest header.
    records
        Data of the variable length records, by user and number; of the extended ones those of
        the coordinate system.
    """

    minor: int
    form: int
    length: int
    count: int
    start: int
    scales: npt.NDArray[np.float64]
    offsets: npt.NDArray[np.float64]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]
    extras: tuple[Extra, ...]
    laszip: bytes
    head: bytes = b""
    records: dict[tuple[str, int], bytes] = field(default_factory=dict)


def read_las_header(source: Source) -> LasHeader:
    """Return the header; what it says of itself fits the file's size.

    Raises
    ------
    InputError
        If it is no header, of another version or format, or promises more than the file holds.
    """
    from laspy import PointFormat  # not before a LAS file is read

    source.stream.seek(0)
    head = source.stream.read(max(LENGTHS))
    if head[:4] != b"LASF":
        kind = source.suffix[1:].upper()
        raise InputError(f"cannot be read as {kind}: it does not begin with LASF")
    major, minor = head[24:26] if len(head) > 25 else (0, 0)
    if major != 1 or minor >= len(LENGTHS):
        raise InputError(f"is LAS {major}.{minor}; 1.0 to 1.4 are read")
    if len(head) < LENGTHS[minor]:
        raise InputError("ends inside its header; is it damaged, or truncated?")
    size, start, records, form, length, count = struct.unpack_from("<HIIBHI", head, 94)
    if minor >= 4:
        count = struct.unpack_from("<Q", head, 247)[0] or count
    numbers = np.frombuffer(head, "<f8", 6, 131).astype(np.float64)
    compressed, form = bool(form & 0x80), form & 0x3F
    if form > LAST_FORMAT:
        raise InputError(f"has points of format {form}; 0 to {LAST_FORMAT} are read")
    if size < LENGTHS[minor] or not size + RECORD * records <= start <= source.size:
        raise InputError("its header does not fit the file's size; is it damaged, or truncated?")
    least = PointFormat(form).size
    if length < least:
        raise InputError(
            f"has points of {length} bytes; format {form} needs {least}; is it damaged?"
        )
    if not np.isfinite(numbers).all() or not numbers[:3].all():
        raise InputError("has scales and offsets that make no coordinates; is it damaged?")
    if not count:
        raise InputError("has no points")
    found = _records(source, size, records, start)
    if minor >= 4:
        for key, data in _extended_records(source, *struct.unpack_from("<QI", head, 235)):
            found.setdefault(key, data)
    laszip = found.get(LASZIP, b"")
    if compressed and not laszip:
        raise InputError("has no record that tells how it is compressed; is it damaged?")
    extras = _extras(found.get(EXTRA_BYTES, b""), PointFormat(form), length)
    laszip = laszip if compressed else b""
    scales, offsets = numbers[:3], numbers[3:]
    high, low = np.frombuffer(head, "<f8", 6, 179).astype(np.float64).reshape(3, 2).T
    return LasHeader(
        minor, form, length, count, start, scales, offsets, low, high, extras, laszip, head, found
    )


def _records(source: Source, at: int, count: int, end: int) -> dict[tuple[str, int], bytes]:
    """Return the data of the variable length records, by user and number."""
    source.stream.seek(at)
    block = source.stream.read(end - at)
    found: dict[tuple[str, int], bytes] = {}
    at = 0
    for _ in range(count):
        if at + RECORD > len(block):
            raise InputError("its header promises more records than it has; is it damaged?")
        user, number, length = struct.unpack_from("<2x16sHH", block, at)
        key = (user.split(b"\0")[0].decode("latin-1"), number)
        at += RECORD
        found.setdefault(key, block[at : at + length])
        at += length
    return found


def _extended_records(
    source: Source, at: int, count: int
) -> Iterator[tuple[tuple[str, int], bytes]]:
    """Yield the extended records of the coordinate system, by user and number.

    Points are drawn without them, so that what does not fit the file is passed over.
    """
    for _ in range(min(count, MOST_EXTENDED)):
        if not 0 < at <= source.size - EXTENDED.size:
            return
        source.stream.seek(at)
        user, number, length = EXTENDED.unpack(source.stream.read(EXTENDED.size))
        at += EXTENDED.size
        name = user.split(b"\0")[0].decode("latin-1")
        if name == PROJECTION and length <= min(LONGEST_EXTENDED, source.size - at):
            yield (name, number), source.stream.read(length)
        at += length


def _extras(block: bytes, form: Any, length: int) -> tuple[Extra, ...]:
    """Return the fields of the extra bytes that are one number, or three."""
    names: list[str] = []
    found: list[tuple[str, int, float, float]] = []
    at = form.size
    for first in range(0, len(block) - DESCRIPTION + 1, DESCRIPTION):
        piece = block[first : first + DESCRIPTION]
        number, options = piece[2], piece[3]
        name = piece[4:36].split(b"\0")[0].decode("latin-1").strip() or f"extra {len(names)}"
        if not number:  # bytes without a meaning
            at += options
            continue
        kind = KINDS[(number - 1) % 10]
        parts = 1 + (number - 1) // 10
        if parts > 3 or at + parts * np.dtype(kind).itemsize > length:
            break
        scales = np.frombuffer(piece, "<f8", 3, 112) if options & SCALED else np.ones(3)
        shifts = np.frombuffer(piece, "<f8", 3, 136) if options & SHIFTED else np.zeros(3)
        for part in range(parts):
            names.append(f"{name}:{part}" if parts > 1 else name)
            found.append((kind, at, float(scales[part]), float(shifts[part])))
            at += np.dtype(kind).itemsize
    taken = ["x", "y", "z", *form.dimension_names]
    marked = unique_names([*taken, *names])[len(taken) :]
    return tuple(
        Extra(name, "<" + kind, start, scale, shift)
        for name, (kind, start, scale, shift) in zip(marked, found, strict=True)
    )
