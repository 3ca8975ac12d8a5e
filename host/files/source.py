"""The bytes of a cloud file: unpacked if they are compressed, and with a known size."""

from __future__ import annotations

import gzip
import os
import shutil
import stat
import tempfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, cast

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError
from splatline.contract.progress import part_of

from .available_memory import available_memory
from .wanted import USUAL, Wanted

__all__ = [
    "Progress",
    "Source",
    "cloud_name",
    "format_suffix",
    "open_source",
    "unpacked_limit",
    "usual_up",
]

GZIP = b"\x1f\x8b"

EXPANSION = 250
"""Most bytes that one compressed byte of a cloud stands for. Deflate can reach 1,032, but a file
that does so holds one value over and over."""

ALWAYS_ALLOWED = 1 << 26
"""Bytes that any compressed file may hold: 64 MB."""

PIECE = 1 << 20

LARGE_PIECE = 1 << 24
"""Bytes that are read at once where nothing is computed of them."""

SURVEYS = (".las", ".laz", ".e57", ".ptx")
"""Formats of surveyors, whose z points up."""

TEXTS = (".xyz", ".xyzn", ".xyzrgb", ".txt", ".asc", ".csv", ".pts", ".ptx")
"""Formats of text alone."""

UNPACKING = 0.5
"""Share of a compressed file's reading that is told when it is unpacked."""

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Source:
    """An open cloud file.

    Parameters
    ----------
    stream
        The bytes, at their start; can be positioned.
    size
        Number of bytes.
    suffix
        The name's suffix that tells the format, in lower case.
    progress
        Called now and then with the share of the bytes that are read; see :meth:`tell`.
    wanted
        What the file is read for.
    path
        The file, beside which others may lie that it names; None for a pipe.
    """

    stream: BinaryIO
    size: int
    suffix: str
    progress: Progress | None = None
    wanted: Wanted = USUAL
    path: Path | None = None

    def tell(self) -> None:
        """Tell ``progress``, if there is one, how much is read."""
        if self.progress is not None:
            self.progress(self.stream.tell() / self.size)

    def read(self, most: int) -> npt.NDArray[np.uint8]:
        """Return the next bytes, up to ``most``, and tell how much is read after each piece."""
        data = np.empty(max(0, min(most, self.size - self.stream.tell())), np.uint8)
        at = 0
        while at < len(data):
            count = self.stream.readinto(memoryview(data[at : at + LARGE_PIECE]))  # type: ignore[attr-defined]
            if not count:
                break
            at += count
            self.tell()
        return data[:at]


def format_suffix(path: Path) -> str:
    """Return the suffix that tells a file's format, in lower case: ``.ply`` of ``a.PLY.gz``."""
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).suffix.lower()


def cloud_name(path: Path) -> str:
    """Return a file's name without the suffixes of format and compression."""
    if str(path) == "-":
        return "stdin"
    return path.with_suffix("").stem if path.suffix.lower() == ".gz" else path.stem


def usual_up(path: Path, format: str | None = None) -> str:
    """Return the axis that points up by the habit of a file's format: z in those of surveyors."""
    suffix = format_suffix(path) if format is None else "." + format.lower().removeprefix(".")
    return "z" if suffix in SURVEYS else "y"


def unpacked_limit(size: int) -> int:
    """Return the most bytes that ``size`` compressed bytes may become."""
    return max(ALWAYS_ALLOWED, EXPANSION * size)


@contextmanager
def open_source(
    path: Path,
    progress: Progress | None = None,
    wanted: Wanted = USUAL,
    suffix: str | None = None,
) -> Iterator[Source]:
    """Open a cloud file. A pipe is read to its end first; a gzip file is unpacked.

    ``-`` is the standard input. ``progress`` is called now and then with the share that is read,
    unpacking included. ``wanted`` is what the file is read for. ``suffix`` tells the format if the
    name does not.

    Raises
    ------
    InputError
        If it is a device, empty, or compressed and damaged.
    OSError
        If it cannot be read.
    """
    is_input = str(path) == "-"
    mode = os.fstat(0).st_mode if is_input else path.stat().st_mode
    named = suffix or format_suffix(path)
    if is_input and os.isatty(0):
        raise InputError("the standard input is a terminal; write a cloud to it by a pipe")
    if not (stat.S_ISREG(mode) or stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)):
        raise InputError("is a device, not a file; give the name of a file")
    with (
        open(0 if is_input else path, "rb", closefd=not is_input) as opened,
        tempfile.TemporaryFile() as scratch,
    ):
        stream = cast(BinaryIO, opened)
        if not stat.S_ISREG(mode):
            shutil.copyfileobj(opened, scratch, PIECE)
            stream = cast(BinaryIO, scratch)
        size = stream.seek(0, 2)
        stream.seek(0)
        if not size:
            what = "file" if stat.S_ISREG(mode) else "pipe"
            raise InputError(f"the {what} is empty")
        compressed = stream.read(2) == GZIP
        stream.seek(0)
        if not compressed:
            if path.suffix.lower() == ".gz":
                raise InputError("is not compressed, although its name ends in .gz; rename it")
            yield Source(stream, size, named, progress, wanted, None if is_input else path)
            return
        with tempfile.TemporaryFile() as unpacked:
            packed = Source(stream, size, "", part_of(progress, 0.0, UNPACKING))
            fits = available_memory() if named in TEXTS else None
            _unpack(packed, cast(BinaryIO, unpacked), unpacked_limit(size), fits)
            size = unpacked.seek(0, 2)
            unpacked.seek(0)
            if not size:
                raise InputError("the file is empty")
            rest = part_of(progress, UNPACKING, 1.0)
            beside = None if is_input else path
            yield Source(cast(BinaryIO, unpacked), size, named, rest, wanted, beside)


def _unpack(packed: Source, to: BinaryIO, limit: int, fits: int | None) -> None:
    """Write what a gzip file holds, and no more than ``limit`` bytes of it.

    Nor more than ``fits``, the bytes of memory for the points of a text: a point takes at least as
    many as its line.
    """
    written = 0
    try:
        with gzip.GzipFile(fileobj=packed.stream) as stream:
            while piece := stream.read(PIECE):
                written += len(piece)
                if written > limit:
                    raise InputError(
                        f"unpacks to more than {limit:,} bytes; it is damaged, or no cloud"
                    )
                if fits is not None and written > fits:
                    raise InputError(
                        f"unpacks to more text than fits the memory, in which {fits:,} bytes are"
                        " left; write it as LAZ or binary PLY"
                    )
                to.write(piece)
                packed.tell()
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError(f"cannot be decompressed; is it damaged? ({error})") from None
