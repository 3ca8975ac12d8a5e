"""Rows of a binary PLY file, read from any one to any other without those before."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, Meaning, find_meaning, gather
from .empty_returns import Empty
from .gaussians import are_gaussians
from .ply_header import read_header
from .read_ply import has_faces, points_of
from .source import Source
from .wanted import Wanted

__all__ = ["PlyRows", "ply_rows"]


class PlyRows(NamedTuple):
    """The points of a binary PLY file whose rows have one length.

    Parameters
    ----------
    start
        The first byte of the first row.
    points
        Number of rows.
    kind
        A row's type.
    mesh
        Whether the points are vertices of faces.
    """

    start: int
    points: int
    kind: np.dtype[np.void]
    mesh: bool = False

    def meaning(self, wanted: Wanted) -> Meaning:
        """Return what the properties are taken for."""
        assert self.kind.names is not None
        meaning = find_meaning(list(self.kind.names), wanted=wanted)
        assert meaning is not None
        return replace(meaning, empty=Empty.KEPT) if self.mesh else meaning

    def read(
        self, source: Source, places: npt.NDArray[np.int64], length: int, meaning: Meaning
    ) -> Columns:
        """Return ``length`` rows from each of some places, or those up to the end.

        Raises
        ------
        InputError
            If the file ends before.
        """
        pieces = []
        for place in places.tolist():
            source.stream.seek(self.start + place * self.kind.itemsize)
            wanted = min(length, self.points - place) * self.kind.itemsize
            data = source.read(wanted)
            if len(data) < wanted:
                raise InputError("ends before its last point; is it damaged, or truncated?")
            pieces.append(data.view(self.kind))
        rows = np.concatenate(pieces)
        return gather({name: rows[name] for name in meaning.names}, meaning)


def ply_rows(source: Source) -> PlyRows | None:
    """Return where the points of a PLY file lie; None if they can only be read as a whole.

    That is so if the file is text, if its points or what is before them have lists, or if they are
    Gaussian splats, which become discs.

    Raises
    ------
    InputError
        If the header is damaged, or has no points.
    """
    header = read_header(source)
    chosen = points_of(header)
    if header.order is None or are_gaussians(chosen.scalars):
        return None
    start = header.size
    for element in header.elements:
        if element.has_lists:
            return None
        kind = element.dtype(header.order)
        if element is chosen:
            return PlyRows(start, element.count, kind, has_faces(header))
        start += element.count * kind.itemsize
    return None
