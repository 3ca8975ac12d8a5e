"""The meaning of columns that have no names: their number and values tell it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .colours import greys
from .column_names import no_field, plain_name
from .columns import Columns
from .empty_returns import EMPTY_NOTE, check_seen, empty_of, seen_rows
from .ranges import range_of
from .wanted import EMPTY, HEIGHT, INTENSITY, RGB, USUAL, ColourBy, Wanted

__all__ = ["by_number"]

_Rows = npt.NDArray[Any]


def by_number(
    rows: _Rows, suffix: str, notes: tuple[str, ...] = (), wanted: Wanted = USUAL
) -> Columns:
    """Return the points of rows without names.

    - 3 columns: position;
    - 4: position and a value that is ignored; the intensity, drawn as grey, if it is ``.pts``;
    - 6: position, then a colour if the file is ``.xyzrgb``; a normal if it is ``.xyzn`` or (nearly)
      all these are unit vectors; else a colour;
    - 7: position, an intensity that is ignored, and a colour; or the intensity last, if only then
      the colours are bytes;
    - 9: position, normal and colour, or position, colour and normal if it is the last that
      are unit vectors.

    The columns are called ``column 1``, ``column 2`` and so on. A fourth column may be asked for as
    an intensity in every format.

    Parameters
    ----------
    rows
        Shape (n, columns), any real type.
    suffix
        The file's format.
    notes
        What is known of the file already.
    wanted
        What colours a point, and whether ranges are wanted.

    Raises
    ------
    InputError
        If the number of columns means nothing, or there is no column of what is to colour a point.
    """
    seen = seen_rows([rows[:, i] for i in range(min(3, rows.shape[1]))], empty_of(wanted))
    if seen is not None:
        check_seen(seen)
        rows, notes = rows[seen], (*notes, EMPTY_NOTE)
    found = _usual(rows, suffix, notes)
    if seen is not None:
        found.dropped[EMPTY] = len(seen) - len(rows)
    if wanted.ranges:
        ranges = {f"column {i + 1}": range_of(column) for i, column in enumerate(rows.T)}
        found = replace(found, ranges=ranges)
    return found if wanted.colour is None else _coloured(found, rows, wanted.colour)


def _usual(rows: _Rows, suffix: str, notes: tuple[str, ...]) -> Columns:
    """Return the points in the colours that they have; see ``by_number``."""
    count = rows.shape[1]
    normal = colour = extra = 0
    if count == 4:
        extra = 3
    elif count == 6:
        is_normal = suffix == ".xyzn" or (suffix != ".xyzrgb" and _are_unit(rows[:, 3:6]))
        normal, colour = (3, 0) if is_normal else (0, 3)
    elif count == 7:
        last = not _are_bytes(rows[:, 4:7]) and _are_bytes(rows[:, 3:6])
        colour, extra = (3, 6) if last else (4, 3)
    elif count == 9:
        swapped = suffix != ".xyzn" and _are_unit(rows[:, 6:9]) and not _are_unit(rows[:, 3:6])
        normal, colour = (6, 3) if swapped else (3, 6)
    elif count != 3:
        raise InputError(
            f"has {count} columns without names; start it with a line that names them,"
            " such as 'x y z r g b', with a name for each"
        )
    used = dict.fromkeys(("column 1", "column 2", "column 3"), "position")
    for first, meaning in ((normal, "normal"), (colour, "colour")):
        if first:
            used |= {f"column {first + 1 + i}": meaning for i in range(3)}
    ignored: tuple[str, ...] = ()
    if extra and count == 4 and suffix == ".pts":
        used["column 4"] = "intensity, as grey"
        return Columns(rows[:, :3], None, greys(rows[:, 3]), used, (), notes)
    if extra:
        ignored = (f"column {extra + 1}",)
        notes = (*notes, f"not used: column {extra + 1}, which may be an intensity")
    return Columns(
        rows[:, :3],
        rows[:, normal : normal + 3] if normal else None,
        rows[:, colour : colour + 3] if colour else None,
        used,
        ignored,
        notes,
    )


def _coloured(found: Columns, rows: _Rows, colour: ColourBy) -> Columns:
    """Return the points with what is to colour them; other colours are left out."""
    names = [f"column {i + 1}" for i in range(rows.shape[1])]
    own = [name for name, meaning in found.used.items() if meaning == "colour"]
    if colour.kind == RGB:
        if not own:
            raise no_field(colour, names)
        return replace(found, colour=colour)
    chosen = None
    if colour.kind == INTENSITY:
        grey = [name for name, meaning in found.used.items() if meaning.startswith("intensity")]
        chosen = next(iter([*grey, *found.ignored]), None)
    elif colour.kind != HEIGHT:
        asked = plain_name(colour.field)
        chosen = next((name for name in names if plain_name(name) == asked), None)
    if chosen is None and colour.kind != HEIGHT:
        raise no_field(colour, names)
    used = {name: what for name, what in found.used.items() if what in ("position", "normal")}
    if chosen is not None:
        what = "intensity" if colour.kind == INTENSITY else "value"
        kind = f"{what}, as {'grey' if what == 'intensity' and colour.map is None else 'colour'}"
        used[chosen] = f"{used[chosen]}; {kind}" if chosen in used else kind
    return replace(
        found,
        colours=None,
        used=used,
        ignored=tuple(name for name in names if name not in used),
        notes=tuple(note for note in found.notes if not note.startswith("not used")),
        values=None if chosen is None else rows[:, names.index(chosen)],
        colour=colour,
    )


def _are_bytes(values: _Rows) -> bool:
    """Return whether (nearly) all values are whole numbers from 0 to 255."""
    finite = values[np.isfinite(values).all(axis=1)].astype(np.float64)
    good = ((finite >= 0.0) & (finite <= 255.0) & (finite == np.trunc(finite))).all(axis=1)
    return bool(np.count_nonzero(good) > 0.99 * len(finite))


def _are_unit(vectors: _Rows) -> bool:
    """Return whether nearly all vectors are of length 1, as far as a few digits tell."""
    finite = vectors[np.isfinite(vectors).all(axis=1)].astype(np.float64)
    finite = finite[(np.abs(finite) <= 2.0).all(axis=1)]
    length = np.linalg.norm(finite, axis=1)
    # Black is (0, 0, 0) and a missing normal too.
    if not np.count_nonzero(np.abs(length - 1.0) < 0.02) > 0.9 * len(vectors):
        return False
    # Labels: corners of the colour cube. Normals along the axes point both ways, or all one way.
    corners = bool(np.all((finite == 0.0) | (finite == 1.0)))
    return not corners or bool((finite == finite[0]).all())
