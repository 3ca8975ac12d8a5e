"""COPC: a LAZ file whose chunks are the nodes of an octree (https://copc.io, version 1.0).

Each node holds some of the points in its cube, evenly spaced; nodes below it hold finer ones.
"""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .las_drawn import Drawn
from .las_fields import Fields, Table
from .las_header import LasHeader
from .laz_chunks import LAYERED, VARIABLE, Layers, parse_laszip
from .source import Source, unpacked_limit

__all__ = ["COPC", "Octree", "copc_sample", "copc_tables", "read_octree"]

COPC = ("copc", 1)
"""User and number of the record that tells of the octree. It is the first one."""

INFO = struct.Struct("<5d2Q")
"""The octree's centre, half of its side and the points' spacing in its root; the root's page."""

ENTRY = np.dtype([
    ("level", "<i4"), ("x", "<i4"), ("y", "<i4"), ("z", "<i4"),
    ("offset", "<u8"), ("size", "<i4"), ("count", "<i4"),
])  # fmt: skip
"""A node: its place among those of its level, its chunk, and its number of points."""

PAGE = -1
"""Count of an entry that is in another page."""

DEEPEST = 30
"""Greatest level."""

SLACK = 1e-3
"""Share of its side by which points may lie outside of the root's cube, by rounding."""

_Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Octree:
    """The octree of a file.

    Parameters
    ----------
    corner
        The least corner of the root's cube: shape (3,), float64.
    side
        Its side.
    spacing
        Distance between the root's points. That of each level is half as large.
    nodes
        The nodes that have points: shape (n,), of ``ENTRY``, by ascending offset.
    """

    corner: _Floats
    side: float
    spacing: float
    nodes: npt.NDArray[Any]

    def cubes(self) -> tuple[_Floats, _Floats]:
        """Return the least corner of each node's cube, shape (n, 3), and its side, shape (n,)."""
        sides = np.ldexp(self.side, -self.nodes["level"])
        places = np.stack([self.nodes[axis] for axis in "xyz"], axis=1)
        return self.corner + places * sides[:, np.newaxis], sides

    def spacings(self) -> _Floats:
        """Return the distance between points of each node: shape (n,)."""
        spacings: _Floats = np.ldexp(self.spacing, -self.nodes["level"])
        return spacings


def read_octree(source: Source, header: LasHeader) -> Octree | None:
    """Return the octree of a file, or None if it has none. It fits the file's size.

    Raises
    ------
    InputError
        If the octree is damaged.
    """
    if not header.laszip or next(iter(header.records)) != COPC:
        return None
    info = header.records[COPC]
    if len(info) < INFO.size:
        raise InputError("ends inside its record of the octree; is it damaged?")
    *numbers, at, size = INFO.unpack_from(info)
    centre, half, spacing = np.array(numbers[:3]), numbers[3], numbers[4]
    if not np.isfinite(numbers).all() or min(half, spacing) <= 0.0:
        raise InputError("has an octree without a size; is it damaged?")
    corner, side = centre - half, 2.0 * half
    slack = SLACK * side
    if not ((corner - slack <= header.low) & (header.high <= corner + side + slack)).all():
        raise InputError("has an octree that does not hold its bounds; is it damaged?")
    compressor, chunk, _ = parse_laszip(header)
    if compressor != LAYERED or chunk != VARIABLE:
        raise InputError("has an octree, but no chunks for its nodes; is it damaged?")
    entries = _read_pages(source, at, size)
    return Octree(corner, side, spacing, _checked(source, header, entries))


def _read_pages(source: Source, at: int, size: int) -> npt.NDArray[Any]:
    """Return the entries of all pages of the hierarchy."""
    pages, seen, found, left = [(at, size)], {at}, [], source.size
    while pages:
        at, size = pages.pop()
        left -= size
        if not 0 < size <= source.size - at or size % ENTRY.itemsize:
            raise InputError("has a page of its octree outside of the file; is it damaged?")
        source.stream.seek(at)
        entries = np.frombuffer(source.stream.read(size), ENTRY)
        others = entries[entries["count"] == PAGE]
        next_pages = list(zip(others["offset"].tolist(), others["size"].tolist(), strict=True))
        places = {place for place, _ in next_pages}
        if len(places) < len(next_pages) or places & seen or left < 0:
            raise InputError("has pages of its octree that hold one another; is it damaged?")
        seen |= places
        pages += next_pages
        found.append(entries[entries["count"] != PAGE])
    return np.concatenate(found)


def _checked(source: Source, header: LasHeader, entries: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return the nodes that have points, by ascending offset; what they promise is possible."""
    level = entries["level"]
    good = (level >= 0) & (level <= DEEPEST) & (entries["count"] >= 0)
    width = np.int64(1) << np.clip(level, 0, DEEPEST).astype(np.int64)
    for axis in "xyz":
        good &= (entries[axis] >= 0) & (entries[axis] < width)
    if not good.all():
        raise InputError("has nodes that no octree has; is it damaged?")
    nodes = entries[entries["count"] > 0]
    points = int(nodes["count"].sum(dtype=np.int64))
    if points != header.count:
        raise InputError(f"promises {header.count:,} points, but its octree holds {points:,}")
    nodes = nodes[np.argsort(nodes["offset"], kind="stable")]
    if nodes["offset"][-1] > source.size or nodes["offset"][0] < header.start + 8:
        raise InputError("has nodes outside of the file; is it damaged?")
    starts, sizes = nodes["offset"].astype(np.int64), nodes["size"].astype(np.int64)
    ends = np.append(starts[1:], source.size)
    if (sizes <= header.length).any() or (starts + sizes > ends).any():
        raise InputError("has nodes that overlap, or end outside of the file; is it damaged?")
    if points > unpacked_limit(int(sizes.sum())) // header.length:
        raise InputError(
            f"promises {points:,} points, more than {source.size:,} bytes hold; is it damaged?"
        )
    keys = nodes[["level", "x", "y", "z"]]
    if len(np.unique(keys)) < len(keys):
        raise InputError("has two nodes at one place of its octree; is it damaged?")
    return nodes


def copc_tables(
    source: Source,
    header: LasHeader,
    nodes: npt.NDArray[Any],
    names: Sequence[str],
    points: int,
) -> Iterator[tuple[Table, dict[str, int]]]:
    """Yield some fields of the points of some nodes; see ``las_tables``.

    Parameters
    ----------
    source, header
        The file.
    nodes
        Some of the octree's nodes.
    names
        The fields.
    points
        Most points of a table, unless a single node has more. A table's nodes are decompressed in
        parallel.
    """
    fields = Fields(header, names)
    nodes = nodes[np.argsort(nodes["offset"], kind="stable")]
    cuts = np.concatenate([[0], np.cumsum(nodes["count"], dtype=np.int64)])
    drawn = Drawn(header, fields, source.wanted.keep)
    first = 0
    while first < len(nodes):
        last = max(first + 1, int(np.searchsorted(cuts, cuts[first] + points, "right")) - 1)
        data = _unpack(source, header, nodes[first:last], drawn.read.selection())
        rows, dropped = drawn.split(data.view(fields.dtype))
        first = last
        if source.progress is not None:
            source.progress(cuts[first] / cuts[-1])
        yield fields.table(rows), dropped


def copc_sample(
    source: Source, header: LasHeader, octree: Octree, names: Sequence[str], points: int
) -> Table:
    """Return some fields of up to about ``points`` points from all over the file.

    They are those of the coarsest levels, which are evenly spaced.
    """
    levels = octree.nodes["level"]
    by_level = np.cumsum(np.bincount(levels, octree.nodes["count"]))
    most = int(np.searchsorted(by_level, points, "right"))
    chosen = octree.nodes[levels < max(most, 1 + int(levels.min()))]
    skip = -(-int(chosen["count"].sum(dtype=np.int64)) // points)
    tables = [
        {name: values[::skip] for name, values in table.items()}
        for table, _ in copc_tables(source, header, chosen, names, points)
    ]
    together = Fields(header, names).empty(sum(len(table["x"]) for table in tables))
    for name, values in together.items():
        np.concatenate([table[name] for table in tables], out=values)
    return together


def _unpack(
    source: Source, header: LasHeader, nodes: npt.NDArray[Any], selection: Any
) -> npt.NDArray[np.uint8]:
    """Return the bytes of the points of some nodes."""
    import lazrs  # not before a LAZ file is read

    _, _, items = parse_laszip(header)
    layers = Layers(header, items)
    packed = memoryview(bytearray(int(nodes["size"].sum(dtype=np.int64))))
    at = 0
    for start, size in zip(nodes["offset"].tolist(), nodes["size"].tolist(), strict=True):
        source.stream.seek(start)
        chunk = packed[at : at + size]
        source.stream.readinto(chunk)  # type: ignore[attr-defined]
        layers.check(chunk[layers.first : layers.first + layers.length], size)
        at += size
    data = np.empty(int(nodes["count"].sum(dtype=np.int64)) * header.length, np.uint8)
    table = list(zip(nodes["count"].tolist(), nodes["size"].tolist(), strict=True))
    lazrs.decompress_points_with_chunk_table(packed, header.laszip, data, table, selection)
    return data
