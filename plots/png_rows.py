"""A PNG written by rows, so that a picture of any size takes the memory of some rows."""

from __future__ import annotations

import contextlib
import os
import zlib
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
import numpy.typing as npt
import png

from splatline.host.files.atomic_write import atomic_stream, tell_unwritable

__all__ = ["PngRows", "png_rows"]

NO_FILTER = 0
"""PNG's filter that stores rows as they are. Of a picture of the engine, a flat background with
splats of few colours, that is less than differences from row to row."""


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
        self._path, self._stream = path, stream
        self._bytes = 2 * width if grey else 3 * width
        writer = png.Writer(width, height, greyscale=grey, bitdepth=16 if grey else 8)
        with tell_unwritable(path):
            writer.write_preamble(stream)
        self._compressor = zlib.compressobj()

    def write(self, rows: npt.NDArray[Any]) -> None:
        """Write rows: shape (n, width, 3), uint8; or of a grey picture (n, width), uint16."""
        big_endian = np.ascontiguousarray(rows, rows.dtype.newbyteorder(">"))
        filtered = np.full((len(rows), 1 + self._bytes), NO_FILTER, np.uint8)
        filtered[:, 1:] = big_endian.view(np.uint8).reshape(len(rows), self._bytes)
        self._chunk(self._compressor.compress(filtered))

    def end(self) -> None:
        """Write what is left, when all rows are written."""
        self._chunk(self._compressor.flush())
        with tell_unwritable(self._path):
            png.write_chunk(self._stream, b"IEND")

    def _chunk(self, data: bytes) -> None:
        """Write compressed data as a chunk, unless there is none."""
        with tell_unwritable(self._path):
            if data:
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
