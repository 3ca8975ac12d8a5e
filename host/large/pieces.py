"""Files in pieces: LAS, LAZ and binary PLY by points, COPC by nodes, other formats as a whole."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.host.files.colouring import colour_values, heights
from splatline.host.files.colours import NEUTRAL, brightest, colours_to_bytes, robust_range
from splatline.host.files.columns import Columns, gather
from splatline.host.files.copc import Octree, copc_sample, copc_tables, read_octree
from splatline.host.files.empty_returns import Empty
from splatline.host.files.las_fields import Table
from splatline.host.files.las_header import LasHeader, read_las_header
from splatline.host.files.ply_rows import PlyRows, ply_rows
from splatline.host.files.read_las import las_meaning, las_sample, las_tables
from splatline.host.files.readers import open_cloud_file, parser_errors, read_columns
from splatline.host.files.source import Progress, Source, format_suffix
from splatline.host.files.wanted import EMPTY, HEIGHT, INTENSITY, RGB, ColourBy, Wanted

__all__ = ["Colouring", "PieceFile", "Sample", "colours_of", "rows_of"]

PIECE = 1 << 20
"""Points of a piece."""

SAMPLE = 1 << 18
"""Points of a sample."""

FEWEST_PLACES, MOST_PLACES = 8, 128
"""Places of a file that a sample is from."""

CHUNK = 1 << 16
"""Points that are decompressed for a place, or so."""

IN_PIECES = (".las", ".laz")

IN_ROWS = ".ply"

_Bytes = npt.NDArray[np.uint8]


@dataclasses.dataclass(frozen=True)
class Colouring:
    """How a file's values become colours, the same in all of its pieces.

    Parameters
    ----------
    by
        What colours a point, with its range; None: the file's own colours, or none.
    full
        The value of full brightness of the file's own colours.
    normals
        Whether the file has normals.
    key
        What colours stand for; see ``Cloud.colour_key``.
    """

    by: ColourBy | None
    full: float | None
    normals: bool
    key: dict[str, Any]


@dataclasses.dataclass(frozen=True)
class Sample:
    """Some points from all over a file, and what its header says.

    Parameters
    ----------
    columns
        The points.
    count
        Points that the file promises.
    bounds
        The least and the greatest coordinates, shape (3,) each, as the file says; None: it does
        not.
    in_pieces
        Whether the file can be read from any point to any other. COPC is read by nodes.
    """

    columns: Columns
    count: int
    bounds: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]] | None
    in_pieces: bool


class PieceFile:
    """A file of a cloud.

    Parameters
    ----------
    path
        The file.
    by
        What colours a point; None: the file's colours, else its intensity, else one colour.
    keep
        See ``read_cloud``.

    Attributes
    ----------
    octree
        The octree of a COPC file, once a sample is taken.
    """

    def __init__(self, path: Path, by: ColourBy | None, keep: frozenset[str] = frozenset()) -> None:
        self.path = path
        self._keep = keep
        self._by = by
        self.octree: Octree | None = None
        self._colours = True
        self._in_pieces = format_suffix(path) in IN_PIECES
        self._rows: PlyRows | None = None
        self._empty = Empty.SEVERAL

    def sample(self) -> Sample:
        """Return some points from all over the file.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        with open_cloud_file(self.path, Wanted(self._by, keep=self._keep)) as source:
            if _is_in_rows(self.path):
                with parser_errors(source):
                    self._rows = ply_rows(source)
                if self._rows is not None:
                    return self._sample_of_rows(source, self._rows)
                source.stream.seek(0)
            if not self._in_pieces:
                columns = read_columns(source)
                count = len(columns.positions)
                some = slice(None, None, -(-count // SAMPLE))
                return Sample(rows_of(columns, some), count, None, False)
            with parser_errors(source):
                header = read_las_header(source)
                self.octree = read_octree(source, header)
                meaning = las_meaning(header, source.wanted)
                table = self._sample(source, header, meaning.names)
                black = meaning.kind == "colour" and not any(
                    table[name].any() for name in meaning.colours
                )
                if black and self._by is None:  # as ``read_las`` has it
                    self._colours = False
                    meaning = las_meaning(header, source.wanted, colours=False)
                    table = self._sample(source, header, meaning.names)
                if meaning.kind.startswith("intensity") and self._by is None:
                    self._by = ColourBy(INTENSITY)
                    meaning = las_meaning(header, Wanted(self._by), colours=self._colours)
                bounds = header.low, header.high
                in_pieces = self.octree is None
                columns = self._settled(gather(table, meaning))
                return Sample(columns, header.count, bounds, in_pieces)

    def _sample_of_rows(self, source: Source, rows: PlyRows) -> Sample:
        """Return some points from all over a binary PLY file."""
        meaning = rows.meaning(source.wanted)
        if meaning.kind.startswith("intensity") and self._by is None:
            self._by = ColourBy(INTENSITY)
            meaning = rows.meaning(Wanted(self._by))
        number, length = _places(rows.points)
        if number * length >= rows.points:
            number, length = 1, rows.points
        starts = np.linspace(0, max(rows.points - length, 0), number).astype(np.int64)
        with parser_errors(source):
            columns = self._settled(rows.read(source, starts, length, meaning))
            return Sample(columns, rows.points, None, True)

    def _settled(self, sample: Columns) -> Columns:
        """Settle by a sample which points at exactly 0, 0, 0 are left out of all pieces."""
        self._empty = Empty.ALL if EMPTY in sample.dropped else Empty.KEPT
        return sample

    def _sample(self, source: Source, header: LasHeader, names: Sequence[str]) -> Table:
        """Return some fields of some points from all over a LAS file."""
        if self.octree is not None:
            return copc_sample(source, header, self.octree, names, SAMPLE)
        return las_sample(source, header, names, *_places(header.count))

    def pieces(
        self,
        first: int = 0,
        stop: int | None = None,
        progress: Progress | None = None,
        nodes: npt.NDArray[Any] | None = None,
    ) -> Iterator[Columns]:
        """Yield the points from the number ``first`` up to ``stop``, or the file's end.

        ``dropped`` of each has those left out, by reason. With ``nodes``, some of ``octree``'s, the
        points are theirs.

        Raises
        ------
        InputError
            If the file is damaged.
        """
        with open_cloud_file(self.path, Wanted(self._by, keep=self._keep), progress) as source:
            if self._rows is not None:
                yield from self._pieces_of_rows(source, self._rows, first, stop)
                return
            if not self._in_pieces:
                yield read_columns(source)
                return
            with parser_errors(source):
                header = read_las_header(source)
                meaning = las_meaning(header, source.wanted, colours=self._colours)
                if nodes is not None:
                    tables = copc_tables(source, header, nodes, meaning.names, PIECE)
                else:
                    tables = las_tables(source, header, meaning.names, PIECE, first, stop)
                for table, dropped in tables:
                    columns = gather(table, dataclasses.replace(meaning, empty=self._empty))
                    columns.dropped.update(dropped)
                    yield columns

    def _pieces_of_rows(
        self, source: Source, rows: PlyRows, first: int, stop: int | None
    ) -> Iterator[Columns]:
        """Yield the points of a binary PLY file."""
        meaning = dataclasses.replace(rows.meaning(source.wanted), empty=self._empty)
        end = rows.points if stop is None else stop
        for place in range(first, end, PIECE):
            with parser_errors(source):
                yield rows.read(source, np.array([place]), min(PIECE, end - place), meaning)

    def colouring(self, sample: Columns) -> Colouring:
        """Return how values become colours, so that every piece does as the sample does."""
        by, normals = sample.colour, sample.normals is not None
        if by is None or by.kind == RGB:
            full = None if sample.colours is None else brightest(sample.colours)
            return Colouring(by, full, normals, {})
        if by.kind == HEIGHT:
            values = heights(sample.positions.astype(np.float64), np.zeros(3), by.up)
        else:
            assert sample.values is not None
            values = sample.values.astype(np.float64)
        if by.kind == HEIGHT and by.range is None:  # of the bulk: without strays
            by = dataclasses.replace(by, range=robust_range(values[np.isfinite(values)]))
        key = colour_values(values, by).key
        ends = key.get("range")
        fixed = by if not ends else dataclasses.replace(by, range=tuple(ends))
        return Colouring(fixed, None, normals, key)


def _is_in_rows(path: Path) -> bool:
    """Return whether a file may be a binary PLY that is read by rows: it is not compressed."""
    return path.suffix.lower() == IN_ROWS


def colours_of(columns: Columns, colouring: Colouring) -> _Bytes:
    """Return the colours of a piece: shape (n, 3), uint8."""
    by = colouring.by
    if by is not None and by.kind == HEIGHT:
        positions = columns.positions.astype(np.float64)
        return colour_values(heights(positions, np.zeros(3), by.up), by).colours
    if columns.values is not None and by is not None:
        return colour_values(columns.values, by).colours
    if columns.colours is None:
        return np.tile(np.array(NEUTRAL, np.uint8), (len(columns.positions), 1))
    return colours_to_bytes(columns.colours, colouring.full)


def _places(count: int) -> tuple[int, int]:
    """Return the places of a sample of so many points, and the points from each."""
    places = min(max(count // CHUNK, FEWEST_PLACES), MOST_PLACES)
    return places, SAMPLE // places


def rows_of(columns: Columns, rows: slice | npt.NDArray[np.bool_]) -> Columns:
    """Return some rows of columns."""
    fields = ("positions", "normals", "colours", "values", "radii")
    chosen = {name: getattr(columns, name) for name in fields}
    return dataclasses.replace(
        columns, **{name: array[rows] for name, array in chosen.items() if array is not None}
    )
