"""A PNG written by rows, so that a picture of any size takes the memory of some rows.

The rows are packed in bands, each alone (as pigz does), so that several processes may pack them.
"""

from __future__ import annotations

import contextlib
import os
import zlib
from collections.abc import Iterator
from typing import IO, Any, NamedTuple

import numpy as np
import numpy.typing as npt
import png

from splatline.contract.atomic_write import atomic_stream, tell_unwritable

__all__ = ["Band", "PngRows", "pack_band", "png_rows"]

NO_FILTER = 0
"""PNG's filter that stores rows as they are. Of a picture of the engine, a flat background with
splats of few colours, that is less than differences from row to row."""

RAW = -zlib.MAX_WBITS
"""Deflate without zlib's header and checksum (RFC 1951)."""

HEAD = bytes([0x78, 0x9C])
"""Header of a zlib stream (RFC 1950)."""

ADLER = 65521
"""The modulus of Adler-32 (RFC 1950, section 9)."""


class Band(NamedTuple):
    """Some rows of a PNG, packed.

    Parameters
    ----------
    data
        Deflate blocks that end at a byte.
    adler
        Adler-32 of what they unpack to.
    length
        Bytes of what they unpack to.
    """

    data: bytes
    adler: int
    length: int


def pack_band(rows: npt.NDArray[Any]) -> Band:
    """Pack rows: shape (n, width, 3), uint8; or of a grey picture (n, width), uint16."""
    big_endian = np.ascontiguousarray(rows, rows.dtype.newbyteorder(">"))
    data = big_endian.view(np.uint8).reshape(len(rows), -1)
    filtered = np.full((len(rows), 1 + data.shape[1]), NO_FILTER, np.uint8)
    filtered[:, 1:] = data
    compressor = zlib.compressobj(wbits=RAW)
    packed = compressor.compress(filtered) + compressor.flush(zlib.Z_FULL_FLUSH)
    return Band(packed, zlib.adler32(filtered), filtered.size)


def _joined_adler(one: int, other: int, length: int) -> int:
    """Return the Adler-32 of two texts in a row, from theirs and the second one's length."""
    low = ((one & 0xFFFF) + (other & 0xFFFF) - 1) % ADLER
    high = ((one >> 16) + (other >> 16) + length * ((one & 0xFFFF) - 1)) % ADLER
    return high << 16 | low


class PngRows:
    """The rows of a PNG; see :func:`png_rows`."""

    def __init__(
        self,
        path: str | os.PathLike[str],
        stream: IO[bytes],
        width: int,
        height: int,
        grey: bool,
    ) -> None:
        self._path, self._stream, self._adler = path, stream, zlib.adler32(b"")
        writer = png.Writer(width, height, greyscale=grey, bitdepth=16 if grey else 8)
        with tell_unwritable(path):
            writer.write_preamble(stream)
        self._chunk(HEAD)

    def write(self, band: Band) -> None:
        """Write the next rows."""
        self._adler = _joined_adler(self._adler, band.adler, band.length)
        self._chunk(band.data)

    def end(self) -> None:
        """Write the end, when all rows are written."""
        self._chunk(zlib.compressobj(wbits=RAW).flush() + self._adler.to_bytes(4, "big"))
        with tell_unwritable(self._path):
            png.write_chunk(self._stream, b"IEND")

    def _chunk(self, data: bytes) -> None:
        """Write packed data as a chunk."""
        with tell_unwritable(self._path):
            png.write_chunk(self._stream, b"IDAT", data)


@contextlib.contextmanager
def png_rows(
    path: str | os.PathLike[str], width: int, height: int, *, grey: bool = False
) -> Iterator[PngRows]:
    """Write a PNG by rows, atomically: the file is there when the block has ended.

    Parameters
    ----------
    path
        The file; its folder must exist.
    width, height
        Of the picture.
    grey
        16 bits of grey instead of 8 of red, green and blue.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with atomic_stream(path) as stream:
        rows = PngRows(path, stream, width, height, grey)
        yield rows
        rows.end()
