"""Clouds as text: one line a point, numbers between blanks, commas or semicolons."""

from __future__ import annotations

import codecs
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from math import isfinite

from splatline.contract.errors import InputError

from .columns import Columns, find_meaning, gather, unique_names
from .numbered import by_number
from .numbers import COMMENTS, lines_of, load_rows, split_line, to_number, without_comment
from .source import Source

__all__ = ["Layout", "read_layout", "read_text"]

DELIMITERS = (";", "\t", ",", "|", None)
"""In this order, as commas may be those of decimals. None: blanks."""

MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)

SAMPLE = 4096
"""Bytes by which an encoding is told."""


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
    promised
        Number of points by a line of its own, if there is one.
    words
        Names of the columns that hold no number in the first point.
    """

    names: list[str] | None
    skip: int
    delimiter: str | None
    columns: int
    promised: int | None
    words: tuple[str, ...] = ()


def read_text(source: Source) -> Columns:
    """Return the points of a text file.

    The line before the first point may name the columns, also behind ``#``, ``//`` or ``%``: x, y,
    z; nx, ny, nz; r, g, b or red, green, blue; see ``columns``. Without names the number of columns
    tells their meaning; see ``by_number``. A line with the count of points, titles, empty lines and
    comments (``#``, ``//``, ``%``) do not count.

    Raises
    ------
    InputError
        If there is no point, it is not clear what the columns are, or a line does not fit.
    """
    encoding, layout = read_layout(source)
    lines = partial(lines_of, source, 0, encoding)
    names = layout.names
    meaning = None
    if names is not None:
        meaning = find_meaning(names, dict.fromkeys(layout.words, 0), source.wanted)
    if names is not None and meaning is None:
        raise InputError(f"names its columns {', '.join(names)[:80]}: there is no x, y and z")
    if names is not None and len(names) != layout.columns:
        raise InputError(f"names {len(names)} columns, but has {layout.columns}")
    used = range(layout.columns)
    if names is not None and meaning is not None:
        columns = [names.index(name) for name in meaning.names]
    else:
        columns = list(used)
    rows = load_rows(
        lines,
        columns,
        width=layout.columns,
        delimiter=layout.delimiter,
        skip=layout.skip,
        exact=names is None,
        counts=True,
    )
    if layout.promised is not None and len(rows) < layout.promised:
        raise InputError(f"ends after {len(rows)} of its {layout.promised} points; it is truncated")
    if meaning is None:
        return by_number(rows, source.suffix, wanted=source.wanted)
    return gather({name: rows[:, i] for i, name in enumerate(meaning.names)}, meaning)


def read_layout(source: Source) -> tuple[str, Layout]:
    """Return the encoding, and the layout by the lines up to the first point.

    Raises
    ------
    InputError
        If it is no text, or no line of it is a point.
    """
    encoding = _encoding(source)
    with closing(lines_of(source, 0, encoding)) as lines:
        return encoding, _find_layout(lines)


def _encoding(source: Source) -> str:
    """Return the text's encoding, by its mark or its zeros; raise if it is no text."""
    head = source.stream.read(SAMPLE)
    for mark, encoding in MARKS:
        if head.startswith(mark):
            return encoding
    zeros = head.count(0)
    if not zeros:
        return "utf-8"
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if head[first::2].count(0) == zeros > 0.45 * len(head):
            return encoding
    raise InputError(f"cannot be read as {source.suffix[1:].upper()}: it is not text")


def _find_layout(lines: Iterator[str]) -> Layout:
    """Return the layout, from the lines up to the first point."""
    names: list[str] | None = None
    counts: list[int] = []
    for number, line in enumerate(lines):
        text = line.strip().lstrip("\ufeff")
        comment = next((mark for mark in COMMENTS if text.startswith(mark)), "")
        bare = text.removeprefix(comment).strip() if comment else without_comment(text)
        if not bare:
            continue
        found = None if comment else _numbers(bare, names)
        if found is not None:
            delimiter, columns = found
            if columns == 1 and bare.isdecimal() and not counts:
                counts.append(int(bare))  # of points, unless the file has one column
                continue
            if names is not None and len(names) != columns and find_meaning(names) is None:
                names = None  # a title
            words = _words(split_line(bare, delimiter), names)
            promised = counts[0] if counts else None
            return Layout(names, number, delimiter, columns, promised, words)
        values = _names(bare)
        if find_meaning(values) is not None:
            names = values
        elif comment:
            continue  # prose has no columns called x, y and z
        elif names is not None and find_meaning(names) is not None:
            raise InputError(f"line {number + 1} holds no numbers: {bare[:40]!r}")
        elif len(values) > 2 and not any(map(_is_number, values)):
            names = values
    if names is None:
        raise InputError("has no points: no line of it holds numbers alone")
    raise InputError("has no points")


def _words(values: list[str], names: list[str] | None) -> tuple[str, ...]:
    """Return the names of columns whose value is neither a number nor one that is missing."""
    found = []
    for name, value in zip(names or (), values, strict=False):
        try:
            to_number(value)
        except ValueError:
            found.append(name)
    return tuple(found)


def _is_number(text: str) -> bool:
    try:
        return isfinite(to_number(text))
    except ValueError:
        return False


def _names(text: str) -> list[str]:
    """Return the names in a line; a unit in brackets belongs to the name before it."""
    delimiter = next((mark for mark in DELIMITERS if mark is None or mark in text), None)
    values = [value.strip("\"'") for value in split_line(text, delimiter)]
    if delimiter is None:
        values = [value for value in values if value[0] not in "[(" or value[-1] not in ")]"]
    while len(values) > 1 and not values[-1]:
        values.pop()
    return unique_names(values)


def _numbers(text: str, names: list[str] | None) -> tuple[str | None, int] | None:
    """Return the delimiter and the number of columns of a line of numbers; None if it is none.

    Columns that are not used may hold words. A tab is a blank like others, unless words between
    tabs may hold blanks.
    """
    meaning = None if names is None else find_meaning(names)
    for delimiter in DELIMITERS:
        if delimiter is not None and delimiter not in text:
            continue
        values = split_line(text, delimiter)
        while len(values) > (len(names) if meaning and names else 1) and not values[-1]:
            values.pop()
        used = values
        if meaning is not None and names is not None and len(names) == len(values):
            used = [values[names.index(name)] for name in meaning.names]
        try:
            parsed = [to_number(value) for value in used]
        except ValueError:
            continue
        if meaning is None and len(values) < 3 and not any(map(isfinite, parsed)):
            continue  # a word such as none, or nothing between delimiters
        if delimiter == "\t" and names is None and len(text.split()) == len(values):
            delimiter = None
        return delimiter, len(values)
    return None
