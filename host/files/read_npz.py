"""NPZ and NPY files: arrays by name, or one array."""

from __future__ import annotations

import io
import math
import zipfile
from typing import IO, Any, cast

import numpy as np
import numpy.typing as npt
from numpy.lib import format as npy

from splatline.contract.errors import InputError

from .columns import Columns, find_meaning, gather, plain_name
from .numbered import by_number
from .source import Source, unpacked_limit

__all__ = ["array_shapes", "npy_shape", "read_npy", "read_npz", "values_a_row"]

LONGEST = 1 << 16
"""Bytes of the longest header that is read."""

METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compressions that numpy stores arrays with. Others may take any memory to unpack."""

VECTORS = {
    **dict.fromkeys(("positions", "points", "xyz", "vertices", "pos", "position"), (3,)),
    **dict.fromkeys(("normals", "normal"), (3,)),
    **dict.fromkeys(("colours", "colors", "rgb", "rgba", "colour", "color"), (3, 4)),
}
"""Columns that arrays of these names may have."""

_Array = npt.NDArray[Any]


def read_npz(source: Source) -> Columns:
    """Return the points of an NPZ file.

    Positions are the array ``positions``, ``points``, ``xyz``, ``vertices`` or ``pos``, normals
    ``normals``, colours ``colours``, ``colors`` or ``rgb``, in any case and in the singular too:
    shape (n, 3). A fourth column of colours is ignored. Arrays of one value a point have the names
    of columns in other formats: x, y, z and so on.

    Raises
    ------
    InputError
        If there are no positions, or an array has another shape or no numbers.
    Exception
        Of several types, from numpy and zipfile, if the file is damaged.
    """
    if source.stream.read(6) == npy.MAGIC_PREFIX:
        raise InputError("is one array, not an archive of arrays; let its name end in .npy")
    with zipfile.ZipFile(source.stream) as archive:
        members = _members(archive)
        shapes = array_shapes(archive, source.size)
        widths = {name: values_a_row(name, *shape) for name, shape in shapes.items()}
        meaning = find_meaning(list(members), widths)
        if meaning is None:
            raise InputError("has no array named positions, points, xyz, vertices or pos")
        count = shapes[meaning.positions[0]][0][0]
        for name, (shape, _) in shapes.items():
            if name not in meaning.names and (not shape or shape[0] != count):
                widths[name] = 0  # no value for each point
        meaning = find_meaning(list(members), widths, source.wanted)
        assert meaning is not None
        lengths = {name: shapes[name][0][0] for name in meaning.names}
        for kind_of, group in (("normals", meaning.normals), ("colours", meaning.colours)):
            for name in group:
                if lengths[name] != count:
                    raise InputError(f"has {count} positions but {lengths[name]} {kind_of}")
        if any(lengths[name] != count for name in meaning.positions):
            raise InputError("has arrays x, y and z of different lengths")
        table = {}
        told = _Told(source, sum(members[name].file_size for name in meaning.names))
        for name in meaning.names:
            with archive.open(members[name]) as stream:
                table[name] = npy.read_array(told.of(stream), allow_pickle=False)
    return gather(table, meaning)


class _Told:
    """Tells the share of an archive's arrays that is read.

    Parameters
    ----------
    source
        The file.
    size
        Bytes of the arrays, unpacked.
    """

    def __init__(self, source: Source, size: int) -> None:
        self._progress = source.progress
        self._size = max(size, 1)
        self._read = 0
        self._stream: IO[bytes] | None = None

    def of(self, stream: IO[bytes]) -> IO[bytes]:
        """Return a stream that can be read as the one that is given, piece by piece."""
        self._stream = stream
        return cast(IO[bytes], self)

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, and tell the share."""
        assert self._stream is not None
        data = self._stream.read(size)
        self._read += len(data)
        if self._progress is not None:
            self._progress(min(self._read / self._size, 1.0))
        return data


def array_shapes(
    archive: zipfile.ZipFile, size: int
) -> dict[str, tuple[tuple[int, ...], np.dtype[Any]]]:
    """Return shape and type of each array; ``size`` bytes are enough for them."""
    return {name: _shape(archive, info, size) for name, info in _members(archive).items()}


def values_a_row(name: str, shape: tuple[int, ...], kind: np.dtype[Any]) -> int:
    """Return the values of an array in one row; 0 if they are no column.

    Raises
    ------
    InputError
        If the name is that of positions, normals or colours, and the shape is not.
    """
    wanted = VECTORS.get(plain_name(name))
    packed = len(shape) == 1 and plain_name(name) in ("rgb", "rgba")
    good = kind.kind in "iuf" and (packed or (len(shape) == 2 and shape[1] in (wanted or ())))
    if wanted and not good:
        raise InputError(
            f"its array {name} has shape {shape} and type {kind}; "
            "it must have numbers in shape (n, 3)"
        )
    scalar = len(shape) == 1 and kind.kind in "iuf"
    return 1 if scalar else shape[1] if wanted and len(shape) == 2 else 0


def _members(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Return the arrays of an archive by name; of two of one name the first counts."""
    members = {
        info.filename.removesuffix(".npy"): info
        for info in reversed(archive.infolist())
        if info.filename.endswith(".npy")
    }
    return dict(reversed(members.items()))


def npy_shape(source: Source) -> tuple[tuple[int, ...], np.dtype[Any], dict[str, int]]:
    """Return an array's shape and type, and the values of its fields of numbers in one row.

    Raises
    ------
    InputError
        If it has no rows of numbers, or promises more than the file holds.
    """
    shape, kind = _promise(source.stream, source.size)
    if kind.names is None and (len(shape) != 2 or kind.kind not in "iuf"):
        raise InputError(
            f"is an array of shape {shape} and type {kind}; it must have numbers in shape (n, 3)"
        )
    return (
        shape,
        kind,
        {
            name: math.prod(kind[name].shape)
            for name in kind.names or ()
            if kind[name].base.kind in "iuf"
        },
    )


def read_npy(source: Source) -> Columns:
    """Return the points of an NPY file: rows as in a text without names, or a structured array.

    Raises
    ------
    InputError
        If it has no rows of numbers, or promises more than the file holds.
    Exception
        Of several types, from numpy, if the file is damaged.
    """
    shape, kind, widths = npy_shape(source)
    if kind.hasobject:
        raise InputError("holds Python objects, not numbers alone")
    source.stream.seek(0)
    _, is_fortran, _ = _header(source.stream)
    values = source.read(math.prod(shape) * kind.itemsize).view(kind)
    array = values.reshape(shape, order="F" if is_fortran else "C")
    if kind.names is None:
        return by_number(array, source.suffix, wanted=source.wanted)
    rows = array.reshape(-1)
    parts = {name: rows[name] for name in widths}
    widths = {**dict.fromkeys(kind.names, 0), **widths}
    meaning = find_meaning(list(kind.names), widths, source.wanted)
    if meaning is None:
        raise InputError(f"has no fields x, y and z; it has {', '.join(kind.names)[:80]}")
    return gather(parts, meaning)


def _shape(
    archive: zipfile.ZipFile, info: zipfile.ZipInfo, size: int
) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Return an array's shape and type; the archive is large enough for it."""
    if info.compress_type not in METHODS:
        raise InputError(f"its array {info.filename} is compressed by a method that numpy lacks")
    if info.compress_size > size or info.file_size > unpacked_limit(size):
        raise InputError(
            f"promises {info.file_size:,} bytes of {info.filename}, but has {size:,};"
            " is it damaged?"
        )
    with archive.open(info) as stream:
        return _promise(stream, info.file_size)


def _promise(stream: IO[bytes], size: int) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Return the shape and type that an array's header promises; raise if ``size`` is too small."""
    # From its first bytes, as a header may promise to be 4 GB long.
    head = io.BytesIO(stream.read(LONGEST))
    shape, _, kind = _header(head)
    promised = math.prod(shape) * kind.itemsize
    if min(shape, default=0) < 0 or promised > size - head.tell():
        raise InputError(
            f"promises an array of shape {shape}, {promised:,} bytes, but has {size:,};"
            " is it damaged, or truncated?"
        )
    return shape, kind


def _header(stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Read an array's header: its shape, whether columns lie one behind the other, and its type."""
    version = npy.read_magic(stream)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    return read(stream)
