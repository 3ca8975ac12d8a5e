"""The meaning of a cloud file's columns, by their names: the same for every format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .colours import greys, harmonics_to_bytes, unpack_colours
from .column_names import HINTS, NORMALS, POSITIONS, Names, kinds_of, no_field, plain_name
from .empty_returns import EMPTY_NOTE, Empty, check_seen, empty_of, seen_rows
from .ranges import Range, range_of
from .wanted import EMPTY, HEIGHT, RGB, USUAL, ColourBy, Wanted

__all__ = [
    "Columns",
    "Meaning",
    "bytes_left",
    "find_meaning",
    "gather",
    "plain_name",
    "unique_names",
]

AGAIN = " (again)"


@dataclass(frozen=True)
class Columns:
    """Columns of a file before they are checked; one row a point.

    Parameters
    ----------
    positions
        Shape (n, 3), any real type.
    normals
        Shape (n, 3), any real type and length, or None.
    colours
        Shape (n, 3), in any of the scales of ``colours_to_bytes``, or None.
    used
        What a column of the file was taken for, by its name.
    ignored
        Names of the other columns.
    notes
        What a person should know about how the file was read; each is one line.
    dropped
        Points of the file that are left out, by reason.
    radii
        Shape (n,): radii of the discs in the file's unit, above 0, or None.
    two_sided
        Whether the signs of the normals mean nothing.
    values
        What colours a point if ``colour`` asks for a field: shape (n,), any real type, or None.
    colour
        The request that the reader was given, or None.
    ranges
        The least and the greatest finite value of columns, and how many are not finite, by name, if
        they were asked for; None for both if no value is finite.
    facts
        What else the file says of itself, such as its ``coordinate system``, by a name in words.
    """

    positions: npt.NDArray[Any]
    normals: npt.NDArray[Any] | None = None
    colours: npt.NDArray[Any] | None = None
    used: dict[str, str] = field(default_factory=dict)
    ignored: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    dropped: dict[str, int] = field(default_factory=dict)
    radii: npt.NDArray[Any] | None = None
    two_sided: bool = False
    values: npt.NDArray[Any] | None = None
    colour: ColourBy | None = None
    ranges: dict[str, Range] = field(default_factory=dict)
    facts: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Meaning:
    """The columns that are used, as the file spells them; a group is empty if there is none.

    Parameters
    ----------
    positions, normals
        Three columns, or one column of three values.
    colours
        The same, or one column of packed colours, or of the values that colours stand for.
    kind
        What ``colours`` hold: colour, packed colour, spherical harmonics, intensity, class, value.
    ignored
        The other columns.
    colour
        What colours a point, if it was asked for.
    measured
        Columns of numbers whose ranges are wanted.
    empty
        Which points at exactly 0, 0, 0 are left out.
    """

    positions: Names
    normals: Names
    colours: Names
    kind: str
    ignored: Names
    colour: ColourBy | None = None
    measured: Names = ()
    empty: Empty = Empty.SEVERAL

    @property
    def names(self) -> Names:
        """All columns that are read, each once."""
        wanted = (*self.positions, *self.normals, *self.colours, *self.measured)
        return tuple(dict.fromkeys(wanted))


def unique_names(names: Sequence[str]) -> list[str]:
    """Return names of which those that come again are marked, so that each is a column."""
    seen: set[str] = set()
    found = []
    for name in names:
        other = name
        while other in seen:
            other += AGAIN
        seen.add(other)
        found.append(other)
    return found


def find_meaning(
    names: Sequence[str],
    widths: Mapping[str, int] | None = None,
    wanted: Wanted = USUAL,
) -> Meaning | None:
    """Return the columns of positions, normals and colours, or None without x, y and z.

    Case and units do not matter. Of two columns of one name the first counts.

    Parameters
    ----------
    names
        The columns; none comes twice.
    widths
        Values of a column in one row, if it is not 1; 0 if they are no numbers.
    wanted
        What colours a point, and whether ranges are wanted.

    Raises
    ------
    InputError
        If there is no column of what is to colour a point.
    """
    widths = widths or {}
    spelled = {plain_name(name): name for name in reversed(names)}
    spelled |= {plain_name(name): name for name in reversed(names) if not name.endswith(AGAIN)}

    def first_of(groups: tuple[Names, ...], alone: tuple[int, ...] = (3,)) -> Names:
        for group in groups:
            found = tuple(spelled[name] for name in group if name in spelled)
            sizes = (1,) if len(group) == 3 else alone
            if len(found) == len(group) and all(widths.get(name, 1) in sizes for name in found):
                return found
        return ()

    positions = first_of(POSITIONS)
    if not positions:
        return None
    kinds = kinds_of(wanted.colour)
    found = [(kind, first_of(groups, alone)) for kind, groups, alone in kinds]
    kind, colours = next((pair for pair in found if pair[1]), ("", ()))
    if wanted.colour is not None and not colours and wanted.colour.kind != HEIGHT:
        raise no_field(wanted.colour, [name for name in names if widths.get(name, 1) == 1])
    normals = first_of(NORMALS)
    taken = {*positions, *normals, *colours}
    ignored = tuple(name for name in names if name not in taken)
    measured = [name for name in names if widths.get(name, 1)] if wanted.ranges else []
    return Meaning(
        positions,
        normals,
        colours,
        kind,
        ignored,
        wanted.colour,
        tuple(measured),
        empty_of(wanted),
    )


def gather(table: Mapping[str, Any], meaning: Meaning, notes: Sequence[str] = ()) -> Columns:
    """Return the columns that a meaning names, taken from a table of arrays.

    Returns that found nothing are left out and counted, as ``meaning.empty`` has it.

    Raises
    ------
    InputError
        If all points are such.
    """
    seen = seen_rows(_columns_of(table, meaning.positions), meaning.empty)
    dropped: dict[str, int] = {}
    if seen is not None:
        if meaning.empty is Empty.SEVERAL:
            check_seen(seen)
        table = {name: np.asarray(table[name])[seen] for name in meaning.names}
        dropped[EMPTY] = len(seen) - int(np.count_nonzero(seen))
    if seen is not None or meaning.empty is Empty.ALL:
        notes = (*notes, EMPTY_NOTE)
    colours, values = _stack(table, meaning.colours), None
    if colours is not None:
        if meaning.kind.startswith("packed"):
            colours = unpack_colours(colours[:, 0])
        elif meaning.colour is not None and meaning.colour.kind != RGB:
            values = colours[:, 0]
            colours = None
        elif meaning.kind.startswith("intensity"):
            colours = greys(colours[:, 0])
        elif meaning.kind != "colour":
            colours = harmonics_to_bytes(colours)
        else:
            colours = colours[:, :3]
    positions = _stack(table, meaning.positions)
    assert positions is not None
    used = dict.fromkeys(meaning.positions, "position")
    used |= dict.fromkeys(meaning.normals, "normal")
    for name in meaning.colours:
        used[name] = f"{used[name]}; {meaning.kind}" if name in used else meaning.kind
    return Columns(
        positions,
        _stack(table, meaning.normals),
        colours,
        used,
        meaning.ignored,
        (*notes, *_remarks(meaning)),
        dropped,
        values=values,
        colour=meaning.colour,
        ranges={name: range_of(table[name]) for name in meaning.measured},
    )


def bytes_left(count: int) -> tuple[str, ...]:
    """Return a line about bytes behind the last row; a line end or two need none."""
    if count <= 2:
        return ()
    return (f"{count:,} bytes behind the last point are not read; the header may be wrong",)


def _remarks(meaning: Meaning) -> list[str]:
    """Return a line about columns that come twice, and one about those that may be missed."""
    again = [name.removesuffix(AGAIN) for name in meaning.ignored if name.endswith(AGAIN)]
    lines = [f"{name} comes twice; the first counts" for name in dict.fromkeys(again)]
    missed = [
        name
        for name in meaning.ignored
        if HINTS.search(plain_name(name)) and not name.endswith(AGAIN) and meaning.colour is None
    ]
    if missed:
        shown = ", ".join(missed[:4]) + (f" and {len(missed) - 4} more" if missed[4:] else "")
        lines.append(f"not used: {shown}")
    return lines


def _columns_of(table: Mapping[str, Any], names: Names) -> list[npt.NDArray[Any]]:
    """Return columns of one value a point each, also of one column of several values."""
    columns = [np.asarray(table[name]) for name in names]
    if len(columns) == 1 and columns[0].ndim == 2:
        return list(columns[0].T)
    return columns


def _stack(table: Mapping[str, Any], names: Names) -> npt.NDArray[Any] | None:
    """Return columns side by side, in the machine's own byte order: shape (n, columns)."""
    if not names:
        return None
    if len(names) > 1 and (whole := _whole([table[name] for name in names])) is not None:
        return whole
    if len(names) > 1:
        return np.stack([np.asarray(table[name]) for name in names], axis=-1)
    column = np.asarray(table[names[0]])
    column = column.astype(column.dtype.newbyteorder("="))
    return column if column.ndim == 2 else column[:, np.newaxis]


def _whole(columns: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any] | None:
    """Return the array whose columns these are, if that needs no copy."""
    whole = columns[0].base
    if not isinstance(whole, np.ndarray) or whole.ndim != 2 or whole.shape[1] != len(columns):
        return None
    rows = whole[: len(columns[0])]
    same = all(
        column.__array_interface__ == rows[:, i].__array_interface__
        for i, column in enumerate(columns)
    )
    return rows if same else None
