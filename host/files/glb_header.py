"""The header of a GLB file, and what it promises."""

from __future__ import annotations

import json
import struct
from typing import Any

from splatline.contract.errors import InputError

from .source import Source, unpacked_limit

__all__ = ["check_glb"]

HEADER = struct.Struct("<4sIIII")
"""Magic, version, length of the file, length and type of the first chunk."""

CHUNK = struct.Struct("<II")
"""Length and type."""

FIRST = 12
"""First byte of the first chunk."""

JSON = 0x4E4F534A

BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
"""Bytes of a component, by its type."""

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

PACKED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")
"""Extensions that compress meshes, which trimesh alone does not unpack."""


def check_glb(source: Source) -> None:
    """Raise ``InputError`` if a file is no GLB, or promises more than it may hold."""
    source.stream.seek(0)
    head = source.stream.read(HEADER.size)
    if len(head) < HEADER.size or head[:4] != b"glTF":
        raise InputError("cannot be read as GLB: it does not begin with glTF")
    _, version, length, chunk, kind = HEADER.unpack(head)
    if version != 2:
        raise InputError(f"is glTF {version}; 2 is read")
    if kind != JSON or length > source.size or not _chunks_fit(source):
        raise InputError("its header does not fit the file's size; is it damaged, or truncated?")
    source.stream.seek(HEADER.size)
    try:
        tree = json.loads(source.stream.read(chunk))
        packed = [name for name in PACKED if name in tree.get("extensionsRequired", [])]
        promised = sum(map(_bytes_of, tree.get("accessors", [])))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise InputError("cannot be read as GLB: its JSON is damaged") from None
    if packed:
        raise InputError(f"is compressed by {packed[0]}, which is not read")
    if promised > unpacked_limit(source.size):
        raise InputError(
            f"promises arrays of {promised:,} bytes, but has {source.size:,}; is it damaged?"
        )
    source.stream.seek(0)


def _chunks_fit(source: Source) -> bool:
    """Return whether every chunk ends inside the file."""
    at = FIRST
    while at < source.size:
        source.stream.seek(at)
        head = source.stream.read(CHUNK.size)
        if len(head) < CHUNK.size:
            return True  # bytes that fill the file up
        at += CHUNK.size + CHUNK.unpack(head)[0]
    return at == source.size


def _bytes_of(accessor: dict[str, Any]) -> int:
    """Return the bytes of an array."""
    count = accessor["count"]
    if not isinstance(count, int) or count < 0:
        raise ValueError
    return count * BYTES[accessor["componentType"]] * COMPONENTS[accessor["type"]]
