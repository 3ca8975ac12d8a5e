"""Lines of numbers: by numpy where they are plain, else value by value with repairs."""

from __future__ import annotations

import csv
import io
import re
from array import array
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing, suppress
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .source import Source

__all__ = [
    "COMMENTS",
    "as_declared",
    "lines_of",
    "load_rows",
    "split_line",
    "to_number",
    "without_comment",
]

COMMENTS = ("#", "//", "%")

Lines = Callable[[], Generator[str, None, None]]
"""Returns the lines of a text from its start; it is called once or twice."""

_NO_NUMBER = re.compile(
    r"[-+]?(nan(\([^)]*\)|\d*)|1\.?#(qnan|snan|ind|inf)\d*|null|none|n/?a|-|\?)?", re.IGNORECASE
)
"""Texts that programs write where there is no value."""

_COMMENT = re.compile(r"(?<!\.)#|//|%")
"""Not the mark in ``1.#IND``."""

LINES = 1024
"""Lines after which the progress is told."""

_Rows = npt.NDArray[np.float64]


def lines_of(source: Source, start: int, encoding: str = "utf-8-sig") -> Generator[str, None, None]:
    """Yield the lines of a text that begins at a byte; bytes that are no text become marks."""
    source.stream.seek(start)
    text = io.TextIOWrapper(source.stream, encoding, errors="replace")
    try:
        while lines := list(islice(text, LINES)):
            yield from lines
            source.tell()
    finally:
        if not source.stream.closed:
            text.detach()


def without_comment(line: str) -> str:
    """Return a line without its comment, and without blanks about it."""
    found = _COMMENT.search(line)
    return (line[: found.start()] if found else line).strip().lstrip("\ufeff")


def split_line(line: str, delimiter: str | None) -> list[str]:
    """Return a line's values without quotes; a delimiter inside quotes separates nothing."""
    if delimiter is None:
        return [value.strip("\"'") for value in line.split()]
    quote = next((mark for mark in "\"'" if mark in line), None)
    if quote is None:
        return [value.strip() for value in line.split(delimiter)]
    reader = csv.reader([line], delimiter=delimiter, quotechar=quote, skipinitialspace=True)
    return [value.strip() for value in next(reader)]


def to_number(text: str) -> float:
    """Return the number that a text writes, also with a decimal comma; NaN if it says "none".

    Raises
    ------
    ValueError
        If it is neither.
    """
    try:
        return float(text)
    except ValueError:
        if _NO_NUMBER.fullmatch(text):
            return float("nan")
        if text.count(",") == 1:
            return float(text.replace(",", "."))
        raise


def as_declared(column: npt.NDArray[np.float64], kind: np.dtype[Any]) -> npt.NDArray[Any]:
    """Return whole numbers in the integer type that a header declares, and others as they are.

    Of colours up to 1 the type tells whether they are bytes. Values beyond the type are clipped.
    """
    if kind.kind not in "iu" or not np.all(np.trunc(column) == column):
        return column
    limits = np.iinfo(kind)
    return np.clip(column, limits.min, limits.max).astype(kind)


def load_rows(
    lines: Lines,
    columns: Sequence[int],
    *,
    width: int,
    delimiter: str | None = None,
    skip: int = 0,
    limit: int | None = None,
    exact: bool = True,
    counts: bool = False,
) -> _Rows:
    """Return the numbers of some columns.

    Empty lines and comments do not count. A row without a value is NaN. Three ways are tried: numpy
    on the lines as they are, numpy on lines without comments, and value by value with repairs.

    Parameters
    ----------
    lines
        The text.
    columns
        Columns that are wanted, from 0.
    width
        Columns of a row.
    delimiter
        Separates columns; None for blanks.
    skip
        Lines before the first row.
    limit
        Most rows; None for all.
    exact
        Whether a row with more columns is an error.
    counts
        Whether a line with a single integer is the count of the rows that follow, not a row.

    Returns
    -------
    ndarray
        Shape (n, len(columns)), float64.

    Raises
    ------
    InputError
        If a row has fewer columns, or something that is no number; the message has the line.
    """
    if limit == 0:
        return np.empty((0, len(columns)))
    for clean in (None, without_comment):
        with suppress(ValueError, UserWarning), closing(lines()) as text:
            part = islice(text, skip, None)
            rows = np.loadtxt(
                part if clean is None else map(clean, part),
                np.float64,
                comments=None,
                delimiter=delimiter,
                usecols=None if exact else columns,
                ndmin=2,
                max_rows=limit,
            )
            if rows.shape[1] == (width if exact else len(columns)):
                return rows[:, list(columns)] if exact else rows
    with closing(lines()) as text:
        return _repaired(text, columns, width, delimiter, skip, limit, exact, counts)


def _repaired(
    text: Iterable[str],
    columns: Sequence[int],
    width: int,
    delimiter: str | None,
    skip: int,
    limit: int | None,
    exact: bool,
    counts: bool,
) -> _Rows:
    """Return the numbers of lines that are not plain; see ``load_rows``."""
    found = array("d")
    rows = 0
    for number, raw in enumerate(islice(text, skip, None), start=skip + 1):
        line = without_comment(raw)
        if not line:
            continue
        if limit is not None and rows == limit:
            break
        values = split_line(line, delimiter)
        while len(values) > width and not values[-1]:
            values.pop()
        if counts and len(values) == 1 < width and values[0].isdecimal():
            continue
        if len(values) < width or (exact and len(values) > width):
            raise InputError(
                f"line {number} has {len(values)} of {width} columns; is it damaged? ({line[:40]})"
            )
        try:
            found.extend([to_number(values[column]) for column in columns])
        except ValueError:
            raise InputError(
                f"line {number} holds no numbers; is it damaged? ({line[:40]!r})"
            ) from None
        rows += 1
    return np.frombuffer(found, np.float64).reshape(rows, len(columns)).copy()
