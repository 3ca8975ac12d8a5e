"""The chunks of a LAZ file, checked before lazrs reserves memory for what they promise."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from splatline.contract.errors import InputError

from .las_header import LasHeader
from .source import Source, unpacked_limit

__all__ = ["LAYERED", "VARIABLE", "Layers", "open_laz", "parse_laszip"]

RECORD = struct.Struct("<HHBBHIIqqH")
"""Begin of the LASzip record: compressor, coder, version, options, points of a chunk, special
records, number of items."""

CHUNK_SIZE = struct.Struct("<I")
CHUNK_SIZE_AT = 12
VARIABLE = 0xFFFFFFFF
"""Points of a chunk where chunks differ, as in COPC."""

BY_POINT, CHUNKED, LAYERED = 1, 2, 3

ITEMS = {0: None, 6: 20, 7: 8, 8: 6, 9: 29, 10: 30, 11: 6, 12: 8, 13: 29, 14: None}
"""Bytes of an item by its type; None: those that the record says."""

LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}
"""Layers of an item; extra bytes have one each."""


def open_laz(source: Source, header: LasHeader, selection: Any) -> Any:
    """Return a decompressor at the first point.

    Raises
    ------
    InputError
        If the chunks are not inside the file, or hold other points than the header promises.
    Exception
        Of several types, from lazrs, if the file is damaged otherwise.
    """
    import lazrs  # not before a LAZ file is read

    compressor, size, items = parse_laszip(header)
    limit = unpacked_limit(source.size) // header.length
    if header.count > limit:
        raise InputError(
            f"promises {header.count:,} points, more than {source.size:,} bytes hold;"
            " is it damaged?"
        )
    record = bytearray(header.laszip)
    if size != VARIABLE and not 0 < size <= header.count:
        size = header.count  # one chunk, for which no more memory is needed
        CHUNK_SIZE.pack_into(record, CHUNK_SIZE_AT, size)
    if compressor == BY_POINT:
        source.stream.seek(header.start)
        return lazrs.LasZipDecompressor(source.stream, bytes(record), selection)
    end = _find_table(source, header)
    source.stream.seek(header.start)
    table = lazrs.read_chunk_table(source.stream, lazrs.LazVlr(bytes(record)))
    points = sum(entry[0] for entry in table)
    wanted = header.count if size == VARIABLE else -(-header.count // size) * size
    if points != wanted or points > limit + size % VARIABLE:
        raise InputError(f"promises {header.count:,} points, but its chunks hold {points:,}")
    if sum(entry[1] for entry in table) > end - header.start - 8:
        raise InputError("promises chunks that are longer than the file; is it damaged?")
    if compressor == LAYERED:
        _check_layers(source, header, items, [entry[1] for entry in table])
    source.stream.seek(header.start)
    return lazrs.ParLasZipDecompressor(source.stream, bytes(record), selection)


def parse_laszip(header: LasHeader) -> tuple[int, int, list[tuple[int, int]]]:
    """Return the compressor, the points of a chunk, and type and size of the items of a point.

    Raises
    ------
    InputError
        If the record does not fit the points, or the method is not known.
    """
    try:
        compressor, coder, *_, size, _, _, count = RECORD.unpack_from(header.laszip)
        items = [
            struct.unpack_from("<HH", header.laszip, RECORD.size + 6 * i) for i in range(count)
        ]
    except struct.error:
        raise InputError("ends inside its record of compression; is it damaged?") from None
    good = all(kind in ITEMS and ITEMS[kind] in (None, length) for kind, length in items)
    if coder or not good or sum(length for _, length in items) != header.length:
        raise InputError("has a record of compression that does not fit its points; is it damaged?")
    if compressor not in (BY_POINT, CHUNKED, LAYERED):
        raise InputError(f"is compressed by method {compressor}, which is not known")
    return compressor, size, items


def _find_table(source: Source, header: LasHeader) -> int:
    """Return the byte at which the table of the chunks starts; its length is possible."""
    for place in (header.start, source.size - 8):
        source.stream.seek(place)
        (at,) = struct.unpack("<q", source.stream.read(8).ljust(8, b"\0"))
        if at > header.start:
            break
    source.stream.seek(max(0, min(at, source.size)))
    head = source.stream.read(8)
    if at < header.start + 8 or len(head) < 8:
        raise InputError("has no table of its chunks; is it truncated?")
    (count,) = struct.unpack("<4xI", head)
    # A chunk begins with a point that is not compressed.
    if count > (at - header.start) // header.length + 1:
        raise InputError(f"promises {count:,} chunks, more than the file holds; is it damaged?")
    return at


class Layers:
    """The layers of a chunk: after its first point, as it is, their sizes, then they.

    Parameters
    ----------
    header
        The file's header.
    items
        Type and size of the items of a point.
    """

    def __init__(self, header: LasHeader, items: list[tuple[int, int]]) -> None:
        self.first = header.length + 4
        self.length = 4 * sum(LAYERS.get(kind, length) for kind, length in items)

    def check(self, sizes: bytes | memoryview, chunk: int) -> None:
        """Raise ``InputError`` if the layers are longer than the chunk of ``chunk`` bytes.

        ``sizes`` has up to ``length`` bytes of it, from the byte ``first`` on.
        """
        head = self.first + self.length
        fits = len(sizes) == self.length
        if not fits or head + int(np.frombuffer(sizes, "<u4").sum(dtype=int)) > chunk:
            raise InputError("has chunks that are shorter than their layers; is it damaged?")


def _check_layers(
    source: Source, header: LasHeader, items: list[tuple[int, int]], sizes: list[int]
) -> None:
    """Raise ``InputError`` if a chunk's layers are longer than the chunk."""
    layers = Layers(header, items)
    at = header.start + 8
    for size in sizes:
        source.stream.seek(at + layers.first)
        layers.check(source.stream.read(layers.length), size)
        at += size
