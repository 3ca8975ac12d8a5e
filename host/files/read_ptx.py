"""PTX files: scans one behind the other as text, each with its own transform."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, find_meaning, gather
from .empty_returns import Empty
from .numbers import lines_of
from .source import Source
from .wanted import EMPTY

__all__ = ["read_ptx", "read_ptx_header"]

NAMES = ("x", "y", "z", "intensity", "red", "green", "blue")

HEADER = (1, 1, 3, 3, 3, 3, 4, 4, 4, 4)
"""Numbers in the lines before a scan's points: columns, rows, the scanner's position and axes, and
the transform."""

WIDTHS = (3, 4, 7)
"""Numbers in the line of a point: position, intensity, colour."""

LEAST = 6
"""Bytes of the shortest line of a point."""

PIECE = 1 << 16
"""Lines that are parsed at once."""

_Floats = npt.NDArray[np.float64]


def read_ptx(source: Source) -> Columns:
    """Return the points of all scans, each moved by the matrix before it.

    The matrix has the translation in its last row. Returns that found nothing, at 0 0 0 before the
    transform, are left out and counted, each of them, unless they are to be kept. Scans without
    colours in a file with colours get ``NEUTRAL``.

    Raises
    ------
    InputError
        If a line does not fit, a scan is shorter than it promises, or there are no points.
    """
    lines = _Lines(source)
    scans: list[_Floats] = []
    empty = 0
    while (header := lines.header()) is not None:
        count, matrix = header
        if count > source.size // LEAST:
            raise InputError(
                f"promises {count:,} points, more than {source.size:,} bytes hold; is it damaged?"
            )
        rows = lines.points(count)
        if EMPTY not in source.wanted.keep:
            seen = rows[:, :3].any(axis=1)
            empty += int(np.count_nonzero(~seen))
            rows = rows[seen]
        rows[:, :3] = rows[:, :3] @ matrix[:3, :3] + matrix[3, :3]
        scans.append(rows)
    if not any(map(len, scans)):
        raise InputError("has no points")
    width = max(rows.shape[1] for rows in scans if len(rows))
    whole = np.full((sum(map(len, scans)), width), np.nan)
    at = 0
    for rows in scans:
        whole[at : at + len(rows), : rows.shape[1]] = rows
        at += len(rows)
    names = NAMES[:width]
    meaning = find_meaning(names, wanted=source.wanted)
    assert meaning is not None
    meaning = replace(meaning, empty=Empty.KEPT)  # these are moved by the transforms
    columns = gather({name: whole[:, i] for i, name in enumerate(names)}, meaning)
    if empty:
        columns.dropped[EMPTY] = empty
    return columns


def read_ptx_header(source: Source) -> tuple[int, int, tuple[str, ...]]:
    """Return the scans, their points with those that found nothing, and the names of the columns.

    All lines are passed over, but those of points are not parsed, besides the first of each scan.

    Raises
    ------
    InputError
        If a header does not fit, or a scan is shorter than it promises.
    """
    lines = _Lines(source)
    scans = points = width = 0
    while (header := lines.header()) is not None:
        scans, points = scans + 1, points + header[0]
        width = max(width, lines.skip(header[0]))
    if not points:
        raise InputError("has no points")
    return scans, points, NAMES[:width]


class _Lines:
    """The lines of a file, which know their number."""

    def __init__(self, source: Source) -> None:
        self._lines: Iterator[str] = lines_of(source, 0)
        self._number = 0

    def header(self) -> tuple[int, _Floats] | None:
        """Return the number of points and the matrix of the next scan; None at the end."""
        rows: list[list[float]] = []
        for line in self._lines:
            self._number += 1
            if not line.strip():
                continue
            try:
                row = [float(value) for value in line.split()]
            except ValueError:
                row = []
            if len(row) != HEADER[len(rows)]:
                what = f"line {self._number} does not fit a PTX header: {line.strip()[:40]!r}"
                raise InputError(f"cannot be read as PTX: {what}")
            rows.append(row)
            if len(rows) == len(HEADER):
                break
        if not rows:
            return None
        if len(rows) < len(HEADER):
            raise InputError("ends inside a scan's header; is it damaged, or truncated?")
        sides = [row[0] for row in rows[:2]]
        matrix = np.array(rows[6:])
        if any(side < 0.0 or not side.is_integer() for side in sides):
            raise InputError(f"has a scan of {sides[0]:g} x {sides[1]:g} points; is it damaged?")
        if not np.isfinite(matrix).all():
            raise InputError("has a scan whose transform is none; is it damaged?")
        return int(sides[0]) * int(sides[1]), matrix

    def points(self, count: int) -> _Floats:
        """Return the next points: shape (count, 3, 4 or 7)."""
        pieces: list[_Floats] = []
        left = count
        while left:
            part = list(islice(self._lines, min(left, PIECE)))
            if not part:
                raise _ends(count - left, count)
            pieces.append(self._parse(part))
            self._number += len(part)
            left -= len(part)
        widths = {piece.shape[1] for piece in pieces}
        if len(widths) > 1 or not widths <= {*WIDTHS}:
            if not pieces:
                return np.empty((0, 3))
            raise InputError(
                f"has points of {max(widths)} numbers before line {self._number + 1};"
                " 3, 4 or 7 are read"
            )
        return np.concatenate(pieces)

    def skip(self, count: int) -> int:
        """Pass over the next points; return the numbers of the first one."""
        width = 0
        left = count
        while left:
            part = list(islice(self._lines, min(left, PIECE)))
            if not part:
                raise _ends(count - left, count)
            width = width or self._parse(part[:1]).shape[1]
            self._number += len(part)
            left -= len(part)
        return width

    def _parse(self, lines: list[str]) -> _Floats:
        """Return the numbers of some lines, one row each."""
        try:
            rows = np.loadtxt(lines, np.float64, comments=None, ndmin=2)
            if len(rows) == len(lines):
                return rows
        except ValueError:
            pass
        width = len(lines[0].split())
        for i, line in enumerate(lines):
            try:
                if len([float(value) for value in line.split()]) == width:
                    continue
            except ValueError:
                pass
            where = f"line {self._number + 1 + i}"
            raise InputError(f"{where} is no point; is it damaged? ({line.strip()[:40]!r})")
        raise InputError("cannot be read as PTX; is it damaged?")


def _ends(found: int, count: int) -> InputError:
    """Return the error of a scan that is too short."""
    return InputError(
        f"ends after {found:,} of a scan's {count:,} points; is it damaged, or truncated?"
    )
