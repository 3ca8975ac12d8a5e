"""LAS and LAZ files: version 1.0 to 1.4, every point format; COPC is LAZ too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, Meaning, find_meaning, gather
from .las_drawn import Drawn
from .las_fields import Fields, Table, field_names
from .las_header import LasHeader, read_las_header
from .laz_chunks import open_laz
from .source import Source
from .wanted import USUAL, Wanted

__all__ = ["las_meaning", "las_sample", "las_tables", "read_las"]

PIECE = 1 << 20
"""Points that are decoded at once."""


def read_las(source: Source) -> Columns:
    """Return the points of a LAS or LAZ file.

    Coordinates are the file's integers times its scale plus its offset, in float64: exact to 1e-8
    of a metre at 10^7 metres. Extra bytes may hold normals. If all colours are black, as programs
    write where there is none, the intensity is drawn.

    Points flagged as *withheld* are left out: the standard says that they are deleted. So are those
    classified as noise (7, and 18 in formats from 6 on): whoever classified the scan says that they
    are not of the scene, and a few of them, high above it, would make the picture small. Both are
    counted; ``Wanted.keep`` draws them. Synthetic points and key points are drawn. Files of LAS 1.0
    have no such flags.

    Raises
    ------
    InputError
        If the file is damaged, has no points, or all of them are left out.
    """
    header = read_las_header(source)
    meaning = las_meaning(header, source.wanted)
    table, dropped = _read_all(source, header, meaning.names)
    notes: list[str] = []
    if (
        meaning.colour is None
        and meaning.kind == "colour"
        and not any(table[name].any() for name in meaning.colours)
    ):
        notes.append("all colours are black, so the intensity is drawn")
        meaning = las_meaning(header, source.wanted, colours=False)
        table |= _read_all(source, header, meaning.colours)[0]
    if not len(table["x"]):
        raise InputError(
            f"has no points but {header.count:,} that are withheld or noise; see --keep"
        )
    columns = gather(table, meaning, notes)
    columns.dropped.update(dropped)
    return columns


def las_meaning(header: LasHeader, wanted: Wanted = USUAL, *, colours: bool = True) -> Meaning:
    """Return what the fields of a file are taken for, with its colours or without.

    Raises
    ------
    InputError
        If the file lacks what is to colour a point.
    """
    hidden = () if colours else ("red", "green", "blue")
    names = [name for name in field_names(header) if name not in hidden]
    meaning = find_meaning(names, wanted=wanted)
    assert meaning is not None
    return meaning


def las_tables(
    source: Source,
    header: LasHeader,
    names: Sequence[str],
    points: int,
    begin: int = 0,
    end: int | None = None,
) -> Iterator[tuple[Table, dict[str, int]]]:
    """Yield some fields of the points that are drawn, and how many are left out, by reason.

    They are those from the number ``begin`` up to ``end``, or all.

    Each table stands for up to ``points`` points of the file, at least 1. Its arrays have shape
    (n,): float64 for coordinates and fields with a scale, else the file's own type. Other fields
    are not decompressed, where the format allows that.
    """
    fields = Fields(header, names)
    for rows, dropped in _rows(source, header, fields, points, begin, end):
        yield fields.table(rows), dropped


def las_sample(
    source: Source, header: LasHeader, names: Sequence[str], places: int, points: int
) -> Table:
    """Return some fields of some points: ``points`` from each of evenly spaced places, or of all.

    Points that are left out of a picture are no part of it.
    """
    fields = Fields(header, names)
    if places * points >= header.count:
        places, points = 1, header.count
    starts = np.linspace(0, max(header.count - points, 0), places).astype(int).tolist()
    pieces = [
        rows
        for start in starts
        for rows, _ in _rows(source, header, fields, points, start, start + points)
    ]
    return fields.table(np.concatenate(pieces))


def _read_all(
    source: Source, header: LasHeader, names: Sequence[str]
) -> tuple[Table, dict[str, int]]:
    """Return some fields of all points, and how many points are left out, by reason."""
    fields = Fields(header, names)
    total: dict[str, int] = {}
    table: Table = {}
    at = 0
    for rows, dropped in _rows(source, header, fields, PIECE):
        table = table or fields.empty(header.count)  # the file was found to be large enough
        fields.fill(table, at, rows)
        at += len(rows)
        for reason, count in dropped.items():
            total[reason] = total.get(reason, 0) + count
    return {name: values[:at] for name, values in table.items()}, total


def _rows(
    source: Source,
    header: LasHeader,
    fields: Fields,
    points: int,
    begin: int = 0,
    end: int | None = None,
) -> Iterator[tuple[npt.NDArray[Any], dict[str, int]]]:
    """Yield points of ``fields.dtype`` without those left out, and the number of these.

    They are those from the number ``begin`` up to ``end``, or all.
    """
    drawn = Drawn(header, fields, source.wanted.keep)
    read = _open(source, header, drawn.read, begin)
    left = min(header.count, end or header.count) - begin
    while left:
        count = min(points, left)
        rows, dropped = drawn.split(read(count).view(fields.dtype))
        left -= count
        source.tell()
        yield rows, dropped


def _open(
    source: Source, header: LasHeader, fields: Fields, begin: int
) -> Callable[[int], npt.NDArray[np.uint8]]:
    """Return what reads the bytes of the points from ``begin`` on.

    The file is large enough for all of them.
    """
    if not header.laszip:
        there = (source.size - header.start) // header.length
        if header.count > there:
            raise InputError(
                f"ends after {there:,} of its {header.count:,} points; is it damaged, or truncated?"
            )
        source.stream.seek(header.start + begin * header.length)
        return lambda count: source.read(count * header.length)
    decompressor = open_laz(source, header, fields.selection())
    if begin:
        decompressor.seek(begin)

    def unpack(count: int) -> npt.NDArray[np.uint8]:
        data = np.empty(count * header.length, np.uint8)
        decompressor.decompress_many(data)
        return data

    return unpack
