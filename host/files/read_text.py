"""Clouds as text: one line a point, numbers between blanks, commas or semicolons."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .assemble import Columns
from .columns import Fields, find_fields, stack

__all__ = ["read_text"]

COMMENTS = ("#", "//")

ENCODING = "utf-8-sig"
"""UTF-8, and the mark that some spreadsheets put at its start."""

_Rows = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Layout:
    """The format of a file's lines.

    Parameters
    ----------
    names
        Names of the columns, if the file has them.
    skip
        Lines before the first point.
    delimiter
        Separates columns; None for blanks.
    columns
        Number of columns.
    """

    names: list[str] | None
    skip: int
    delimiter: str | None
    columns: int


def read_text(path: Path) -> Columns:
    """Return the points of a text file.

    The line before the first point may name the columns, also behind ``#`` or ``//``: x, y, z;
    nx, ny, nz; r, g, b or red, green, blue. Other columns are ignored. Without names the number of
    columns tells their meaning:

    - 3: position;
    - 4: position and a value that is ignored;
    - 6: position, then a normal if the file is ``.xyzn`` or (nearly) all these are unit vectors,
      else a colour;
    - 9: position, normal and colour, or position, colour and normal if it is the last that
      are unit vectors.

    Empty lines and comments (``#``, ``//``) do not count.

    Raises
    ------
    InputError
        If there is no point, or it is not clear what the columns are.
    ValueError
        If a line has another number of columns, or something that is no number.
    """
    layout = _find_layout(path)
    fields = None if layout.names is None else find_fields(layout.names)
    if layout.names is not None and fields is None:
        shown = ", ".join(layout.names)[:80]
        raise InputError(f"names its columns {shown}: there is no x, y and z")
    if fields is not None and layout.names is not None:
        return _read_named(path, layout, fields, layout.names)
    return _by_number(_load(path, layout, None), path.suffix.lower())


def _find_layout(path: Path) -> Layout:
    """Return the layout, from the lines up to the first point."""
    names: list[str] | None = None
    with path.open(encoding=ENCODING) as stream:
        for number, line in enumerate(stream):
            text = line.strip()
            comment = next((mark for mark in COMMENTS if text.startswith(mark)), "")
            text = text.removeprefix(comment).strip()
            if not text:
                continue
            delimiter = next((mark for mark in ",;\t" if mark in text), None)
            values = [value.strip().strip("\"'") for value in text.split(delimiter)]
            if not comment and all(map(_is_number, _used(values, names))):
                # A tab is a blank like others, unless words between tabs may hold blanks.
                delimiter = None if delimiter == "\t" and names is None else delimiter
                return Layout(names, number, delimiter, len(values))
            if comment and find_fields(values) is None:
                continue  # prose has no columns called x, y and z
            if names is not None:
                raise InputError(f"line {number + 1} holds no numbers: {text[:40]!r}")
            names = values
    raise InputError("has no points")


def _used(values: list[str], names: list[str] | None) -> list[str]:
    """Return the values of a line that must be numbers: all, or those of columns that are used."""
    fields = find_fields(names) if names is not None and len(names) == len(values) else None
    if fields is None or names is None:
        return values
    return [values[names.index(name)] for group in fields.groups for name in group]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _load(path: Path, layout: Layout, columns: list[int] | None) -> _Rows:
    """Read the numbers of some columns, or of all: shape (n, columns)."""
    with path.open(encoding=ENCODING) as stream:
        return np.loadtxt(
            islice(stream, layout.skip, None),
            np.float64,
            comments=COMMENTS,
            delimiter=layout.delimiter,
            usecols=columns,
            ndmin=2,
        )


def _read_named(path: Path, layout: Layout, fields: Fields, names: list[str]) -> Columns:
    """Return the points of a file whose columns have names."""
    if len(names) != layout.columns:
        raise InputError(f"names {len(names)} columns, but has {layout.columns}")
    used = [names.index(name) for group in fields.groups for name in group]
    rows = _load(path, layout, used)
    columns = {names[column]: rows[:, i] for i, column in enumerate(used)}
    return Columns(
        stack(columns, fields.positions),
        stack(columns, fields.normals) if fields.normals else None,
        stack(columns, fields.colours) if fields.colours else None,
    )


def _by_number(rows: _Rows, suffix: str) -> Columns:
    """Return the points of a file whose columns have no names."""
    count = rows.shape[1]
    positions = rows[:, :3]
    if count in (3, 4):
        return Columns(positions)
    if count == 6:
        if suffix == ".xyzn" or _are_unit(rows[:, 3:6]):
            return Columns(positions, normals=rows[:, 3:6])
        return Columns(positions, colours=rows[:, 3:6])
    if count == 9:
        if suffix != ".xyzn" and _are_unit(rows[:, 6:9]) and not _are_unit(rows[:, 3:6]):
            return Columns(positions, normals=rows[:, 6:9], colours=rows[:, 3:6])
        return Columns(positions, normals=rows[:, 3:6], colours=rows[:, 6:9])
    raise InputError(
        f"has {count} columns without names; start it with a line such as 'x y z r g b'"
    )


def _are_unit(vectors: _Rows) -> bool:
    """Return whether nearly all vectors are of length 1, as far as a few digits tell."""
    finite = vectors[np.isfinite(vectors).all(axis=1)]
    finite = finite[(np.abs(finite) <= 2.0).all(axis=1)]
    length = np.linalg.norm(finite, axis=1)
    # Black is (0, 0, 0) and a missing normal too; pure red, green and blue in 0..1 are unit
    # vectors as well, but a cloud of nothing else is rare.
    return bool(np.count_nonzero(np.abs(length - 1.0) < 0.02) > 0.9 * len(vectors))
