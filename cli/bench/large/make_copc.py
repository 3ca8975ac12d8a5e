"""Makes a COPC file of a LAS or LAZ file. No kept Python library writes COPC: laspy only reads it.

The layout is that of https://copc.io: LAZ 1.4 whose chunks are the nodes of an octree. A point goes
to the first level whose cell of its node is free, as in PDAL's and untwine's writers.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from splatline.host.compiled_cache import cached_njit

__all__ = ["ENTRY", "make_copc"]

BITS = 21
"""Bits of a place along an axis; a Morton code has three times as many."""

CELL_BITS = 7
"""A node has 2^7 = 128 cells along an axis, each with a point at most, unless it is a leaf."""

LEAF = 20_000
"""A node of so few points has them all."""

PAGE_LEVEL = 4
"""Nodes from this level on are in pages of their own, one for each node of this level."""

ENTRY = np.dtype([
    ("level", "<i4"), ("x", "<i4"), ("y", "<i4"), ("z", "<i4"),
    ("offset", "<u8"), ("size", "<i4"), ("count", "<i4"),
])  # fmt: skip
"""An entry of the hierarchy."""

PIECE = 1 << 20

_Ints = npt.NDArray[np.int64]


def make_copc(
    source: Path,
    path: Path,
    *,
    leaf: int = LEAF,
    page_level: int = PAGE_LEVEL,
    progress: Callable[[str, float], None] | None = None,
) -> None:
    """Write the points of a LAS 1.4 file, of format 6 to 8, as COPC.

    It takes memory for all points: about 65 bytes each.

    Parameters
    ----------
    source, path
        The file, and the one that is written.
    leaf
        Most points of a node that has none below it.
    page_level
        Level of the nodes that have pages of their own, above 0.
    progress
        Called now and then with a stage, ``read``, ``sort`` or ``write``, and the share of it.
    """
    import laspy

    def tell(stage: str, share: float) -> None:
        if progress is not None:
            progress(stage, share)

    with laspy.open(source) as reader:
        header = reader.header
        dtype = header.point_format.dtype()
        rows = np.empty(header.point_count, dtype)
        at = 0
        for chunk in reader.chunk_iterator(PIECE):
            rows[at : at + len(chunk)] = chunk.array
            at += len(chunk)
            tell("read", at / len(rows))
    corner, side = _cube(rows, header)
    codes = np.empty(len(rows), np.int64)
    scales = header.scales / side
    shifts = (header.offsets - corner) / side
    _codes(rows["X"], rows["Y"], rows["Z"], scales, shifts, codes)
    tell("sort", 0.0)
    order = np.argsort(codes)
    codes = codes[order]
    levels = _place(codes, leaf)
    tell("sort", 1.0)
    _write(path, header, rows, _in_nodes(codes, order, levels), (corner, side), page_level, tell)


def _cube(rows: npt.NDArray[Any], header: Any) -> tuple[npt.NDArray[np.float64], float]:
    """Return the least corner and the side of the root's cube, which holds all points."""
    ends = [(int(rows[axis].min()), int(rows[axis].max())) for axis in "XYZ"]
    low, high = np.array(ends).T * header.scales + header.offsets
    side = float((high - low).max()) * (1.0 + 1e-6) + 1e-3
    return 0.5 * (low + high) - 0.5 * side, side


@nb.njit(inline="always")
def _spread(place: int) -> int:
    """Return a place's bits with two zeros between each two."""
    spread = place
    spread = (spread | spread << 32) & 0x1F00000000FFFF
    spread = (spread | spread << 16) & 0x1F0000FF0000FF
    spread = (spread | spread << 8) & 0x100F00F00F00F00F
    spread = (spread | spread << 4) & 0x10C30C30C30C30C3
    return (spread | spread << 2) & 0x1249249249249249


@cached_njit(parallel=True)
def _codes(xs: Any, ys: Any, zs: Any, scales: Any, shifts: Any, codes: Any) -> None:
    """Set the Morton code of each point's place in the root's cube."""
    most = (1 << BITS) - 1
    for i in nb.prange(len(codes)):
        x = min(max(np.int64((xs[i] * scales[0] + shifts[0]) * (most + 1)), 0), most)
        y = min(max(np.int64((ys[i] * scales[1] + shifts[1]) * (most + 1)), 0), most)
        z = min(max(np.int64((zs[i] * scales[2] + shifts[2]) * (most + 1)), 0), most)
        codes[i] = _spread(x) | _spread(y) << 1 | _spread(z) << 2


def _place(codes: _Ints, leaf: int) -> npt.NDArray[np.int8]:
    """Return the level of each point, in the order of their codes."""
    levels = np.zeros(len(codes), np.int8)
    left = np.arange(len(codes), dtype=np.uint32)
    for level in range(BITS - CELL_BITS + 1):
        last = level == BITS - CELL_BITS
        left = left[: _place_level(codes, left, level, len(codes) if last else leaf, levels)]
        if not len(left):
            break
    return levels


@cached_njit()
def _place_level(codes: Any, left: Any, level: int, leaf: int, levels: Any) -> int:
    """Place points at a level; those of no free cell move to the front. Return their number.

    The one of a cell's points that gets it is taken by chance, so that there is no pattern.
    """
    node_shift = 3 * (BITS - level)
    cell_shift = node_shift - 3 * CELL_BITS
    kept = 0
    i = 0
    while i < len(left):
        node = codes[left[i]] >> node_shift
        end = i
        while end < len(left) and codes[left[end]] >> node_shift == node:
            end += 1
        if end - i <= leaf:
            for j in range(i, end):
                levels[left[j]] = level
            i = end
        while i < end:
            cell = codes[left[i]] >> cell_shift
            stop = i
            while stop < end and codes[left[stop]] >> cell_shift == cell:
                stop += 1
            chance = np.uint64(left[i]) * np.uint64(0x9E3779B97F4A7C15) >> np.uint64(33)
            taken = i + np.int64(chance) % (stop - i)
            levels[left[taken]] = level
            for j in range(i, stop):
                if j != taken:
                    left[kept] = left[j]
                    kept += 1
            i = stop
    return kept


def _in_nodes(
    codes: _Ints, order: _Ints, levels: npt.NDArray[np.int8]
) -> tuple[npt.NDArray[Any], _Ints]:
    """Return the nodes, as entries with their counts, and the points in their order."""
    entries, points = [], []
    for level in range(int(levels.max()) + 1):
        which = np.flatnonzero(levels == level)
        nodes = codes[which] >> 3 * (BITS - level)
        starts = np.flatnonzero(np.diff(nodes, prepend=-1))
        found = np.zeros(len(starts), ENTRY)
        found["level"] = level
        for axis, name in enumerate("xyz"):
            bits = nodes[starts] >> axis
            found[name] = sum((bits >> 3 * bit & 1) << bit for bit in range(level))
        found["count"] = np.diff(starts, append=len(nodes))
        entries.append(found)
        points.append(order[which])
    return np.concatenate(entries), np.concatenate(points)


def _write(
    path: Path,
    header: Any,
    rows: npt.NDArray[Any],
    nodes: tuple[npt.NDArray[Any], _Ints],
    cube: tuple[npt.NDArray[np.float64], float],
    page_level: int,
    tell: Callable[[str, float], None],
) -> None:
    """Write the file: header, records, chunks, and the record of the hierarchy."""
    import laspy
    import lazrs

    entries, points = nodes
    form = header.point_format
    vlr = lazrs.LazVlr.new_for_compression(form.id, form.num_extra_bytes, True)
    new = laspy.LasHeader(point_format=form, version="1.4")
    new.scales, new.offsets, new.mins, new.maxs = (
        header.scales, header.offsets, header.mins, header.maxs,
    )  # fmt: skip
    new.point_count, new.are_points_compressed = len(points), True
    new.number_of_points_by_return = header.number_of_points_by_return
    new.vlrs.append(laspy.VLR("copc", 1, "COPC info VLR", bytes(160)))
    new.vlrs.append(laspy.VLR("laszip encoded", 22204, "", bytes(vlr.record_data())))
    with path.open("wb+") as file:
        new.write_to(file)
        file.truncate(new.offset_to_point_data)
        file.seek(new.offset_to_point_data)
        compressor = lazrs.ParLasZipCompressor(file, vlr)
        cuts = np.concatenate([[0], np.cumsum(entries["count"], dtype=np.int64)])
        first = 0
        while first < len(entries):
            last = max(first + 1, int(np.searchsorted(cuts, cuts[first] + PIECE)) - 1)
            batch = rows[points[cuts[first] : cuts[last]]]
            ends = cuts[first : last + 1] - cuts[first]
            pairs = zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)
            compressor.compress_chunks([batch[a:b].view(np.uint8) for a, b in pairs])
            first = last
            tell("write", cuts[first] / len(points))
        compressor.done()
        file.seek(new.offset_to_point_data)
        table = np.array(lazrs.read_chunk_table(file, vlr), np.int64)
        assert np.array_equal(table[:, 0], entries["count"])
        entries["size"] = table[:, 1]
        starts = new.offset_to_point_data + 8 + np.cumsum(table[:, 1]) - table[:, 1]
        entries["offset"] = starts
        at = file.seek(0, 2)
        block, root = _pages(entries, at + 60, page_level)
        description = b"EPT hierarchy".ljust(32, b"\0")
        file.write(struct.pack("<H16sHQ", 0, b"copc", 1000, len(block)) + description + block)
        new.start_of_first_evlr, new.number_of_evlrs = at, 1
        corner, side = cube
        times = rows["gps_time"]
        new.vlrs[0].record_data = struct.pack(
            "<5d2Q2d88x", *(corner + 0.5 * side), 0.5 * side, side / (1 << CELL_BITS),
            at + 60, root, times.min(), times.max(),
        )  # fmt: skip
        file.seek(0)
        new.write_to(file)


def _pages(entries: npt.NDArray[Any], at: int, page_level: int) -> tuple[bytes, int]:
    """Return the pages of the hierarchy, which begin at a byte, and the bytes of the root's."""
    above = entries["level"] < page_level
    below = entries[~above]
    depth = below["level"] - page_level
    owners = np.stack([below[axis] >> depth for axis in "xyz"], axis=1)
    owners, which = np.unique(owners, axis=0, return_inverse=True)
    below = below[np.argsort(which.ravel(), kind="stable")]
    counts = np.bincount(which.ravel(), minlength=len(owners))
    pointers = np.zeros(len(owners), ENTRY)
    pointers["level"] = page_level
    for axis, name in enumerate("xyz"):
        pointers[name] = owners[:, axis]
    root = (int(above.sum()) + len(owners)) * ENTRY.itemsize
    pointers["size"] = counts * ENTRY.itemsize
    pointers["offset"] = at + root + np.cumsum(pointers["size"]) - pointers["size"]
    pointers["count"] = -1
    return entries[above].tobytes() + pointers.tobytes() + below.tobytes(), root
