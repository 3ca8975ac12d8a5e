"""E57 files: all scans of a file, each moved by its pose."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, Meaning, find_meaning, gather
from .e57_header import field_names, opened_e57
from .e57_poses import cartesian, moved
from .empty_returns import EMPTY_NOTE, Empty, seen_rows
from .source import Source
from .wanted import EMPTY, Wanted

__all__ = ["read_e57"]

PIECE = 1 << 20
"""Points that are read at once."""

CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
NORMALS = ("nor:normalX", "nor:normalY", "nor:normalZ")
COLOURS = ("colorRed", "colorGreen", "colorBlue")
PLAIN = ("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue")
"""Names of the first three of these groups in other formats."""

INVALID = ("cartesianInvalidState", "sphericalInvalidState")

Table = dict[str, npt.NDArray[Any]]
Names = tuple[str, ...]


def read_e57(source: Source) -> Columns:
    """Return the points of all scans, in the file's own coordinates.

    Spherical coordinates become Cartesian ones, and each scan is rotated and moved by its pose,
    with its normals. Points that are marked as invalid are left out and counted, and so are those
    at exactly 0, 0, 0 before that if a scan has several. Scans without
    colours in a file with colours get ``NEUTRAL``.

    Raises
    ------
    InputError
        If pye57 is missing, or the file is damaged or has no points.
    Exception
        From libE57, if the file is damaged otherwise.
    """
    with opened_e57(source) as (libe57, image, scans, total):
        fields = [field_names(libe57, scan["points"]) for scan in scans]
        meaning = _meaning(fields, source.wanted)
        tables: list[Table] = []
        dropped: Counter[str] = Counter()
        for scan, names in zip(scans, fields, strict=True):
            table, left_out = _read_scan(libe57, image, scan, names, meaning)
            tables.append(table)
            dropped.update(left_out)
            if source.progress is not None:
                source.progress(sum(len(part[meaning.positions[0]]) for part in tables) / total)
    whole = {name: np.concatenate([part[name] for part in tables]) for name in meaning.names}
    notes = (EMPTY_NOTE,) if dropped[EMPTY] else ()
    columns = gather(whole, replace(meaning, empty=Empty.KEPT), notes)
    columns.dropped.update(+dropped)
    return columns


def _meaning(fields: Iterable[Names], wanted: Wanted) -> Meaning:
    """Return what the fields of a file's scans are taken for."""
    every = dict.fromkeys(name for names in fields for name in names)
    places = next((group for group in (CARTESIAN, SPHERICAL) if {*group} <= {*every}), None)
    if places is None:
        raise InputError("has scans without coordinates")
    hidden = {*CARTESIAN, *SPHERICAL, *INVALID} - {*places}
    plain = dict(zip((*places, *NORMALS, *COLOURS), PLAIN, strict=True))
    spelled = {plain.get(name, name): name for name in every if name not in hidden}
    meaning = find_meaning(list(spelled), wanted=wanted)
    assert meaning is not None

    def in_file(names: Names) -> Names:
        return tuple(spelled[name] for name in names)

    return replace(
        meaning,
        positions=places,
        normals=in_file(meaning.normals),
        colours=in_file(meaning.colours),
        ignored=in_file(meaning.ignored),
        measured=in_file(meaning.measured),
    )


def _read_scan(
    libe57: Any, image: Any, scan: Any, names: Names, meaning: Meaning
) -> tuple[Table, dict[str, int]]:
    """Return the valid points of a scan under the meaning's names, and the others by reason."""
    points = scan["points"]
    places = CARTESIAN if all(name in names for name in CARTESIAN) else SPHERICAL
    if any(name not in names for name in places):
        raise InputError("has a scan without coordinates")
    state = next((name for name in INVALID if name in names and name[:5] == places[0][:5]), None)
    others = [name for name in meaning.names if name not in meaning.positions]
    wanted = [*places, *(name for name in others if name in names), *([state] if state else [])]
    prototype = libe57.StructureNode(points.prototype())
    most = min(PIECE, max(1, points.childCount()))
    arrays = {name: np.empty(most, _kind(prototype[name], name)) for name in wanted}
    buffers = libe57.VectorSourceDestBuffer()
    for name, array in arrays.items():
        buffers.append(libe57.SourceDestBuffer(image, name, array, len(array), True, True))
    pieces: dict[str, list[npt.NDArray[Any]]] = {name: [] for name in wanted}
    reader = points.reader(buffers)
    try:
        while count := reader.read():
            for name, array in arrays.items():
                pieces[name].append(array[:count].copy())
    finally:
        reader.close()
    table = {
        name: np.concatenate(parts) if parts else arrays[name][:0] for name, parts in pieces.items()
    }
    found = len(table[places[0]])
    if found < points.childCount():
        raise InputError(f"ends after {found:,} of a scan's {points.childCount():,} points")
    if state:
        valid = table[state] == 0
        table = {name: values[valid] for name, values in table.items()}
    dropped = {"invalid": found - len(table[places[0]])}
    rows = _stack(table, places, 0)
    rows = rows if places == CARTESIAN else cartesian(rows)
    if (seen := seen_rows(list(rows.T), meaning.empty)) is not None:
        rows, table = rows[seen], {name: values[seen] for name, values in table.items()}
        dropped[EMPTY] = len(seen) - len(rows)
    rows = moved(scan, rows)
    result: Table = dict(zip(meaning.positions, rows.T, strict=True))
    if meaning.normals:
        turned = moved(scan, _stack(table, meaning.normals, len(rows)), turn_only=True)
        result |= dict(zip(meaning.normals, turned.T, strict=True))
    for name in others:
        if name not in meaning.normals:
            result[name] = table.get(name, np.full(len(rows), np.nan))
    return result, dropped


def _kind(node: Any, name: str) -> str:
    """Return numpy's type for a field: bytes and 16 bits as such, since they tell a scale."""
    if name in COLOURS and type(node).__name__ == "IntegerNode":
        largest = node.maximum()
        if node.minimum() >= 0 and largest <= 0xFFFF:
            return "B" if largest <= 0xFF else "H"
    return "b" if name in INVALID else "d"


def _stack(table: Table, names: Names, count: int) -> npt.NDArray[np.float64]:
    """Return columns side by side: shape (count, 3); NaN if the scan lacks them."""
    if any(name not in table for name in names):
        return np.full((count, 3), np.nan)
    return np.stack([table[name] for name in names], axis=-1).astype(np.float64)
