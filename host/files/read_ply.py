"""PLY files: ASCII and binary, either endianness."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .columns import Columns, bytes_left, find_meaning, gather
from .empty_returns import Empty
from .gaussians import are_gaussians, gaussian_columns
from .numbers import as_declared, lines_of, load_rows
from .ply_header import Element, Header, read_header
from .ply_lists import list_rows
from .source import Source

__all__ = ["has_faces", "points_of", "read_ply"]

_Table = dict[str, npt.NDArray[Any]]


def read_ply(source: Source) -> Columns:
    """Return the points of a PLY file: the element ``vertex``, or else the first with x, y, z.

    Other elements, such as faces, are ignored, but a file that ends inside them is refused.
    Gaussian splats become discs; see ``gaussian_columns``.

    Raises
    ------
    InputError
        If there is no such element, or the file is damaged.
    """
    header = read_header(source)
    chosen = points_of(header)
    meaning = find_meaning(chosen.scalars, wanted=source.wanted)
    assert meaning is not None
    left = 0
    if header.order is None:
        table = _from_text(source, header, chosen)
    else:
        table, left = _from_bytes(source, header, chosen)
    if are_gaussians(chosen.scalars):
        return gaussian_columns(table, chosen.scalars, bytes_left(left), source.wanted)
    lists = [item.name for item in chosen.properties if item.length is not None]
    if has_faces(header):
        meaning = replace(meaning, empty=Empty.KEPT)  # a vertex of a mesh is no return
    columns = gather(table, meaning, bytes_left(left))
    return replace(columns, ignored=(*columns.ignored, *lists))


def has_faces(header: Header) -> bool:
    """Return whether the points are the vertices of a mesh."""
    return any(element.name == "face" and element.count for element in header.elements)


def points_of(header: Header) -> Element:
    """Return the element ``vertex``, or else the first with x, y and z.

    Raises
    ------
    InputError
        If there is none.
    """
    for element in sorted(header.elements, key=lambda element: element.name != "vertex"):
        if find_meaning(element.scalars) is not None:
            return element
    raise InputError("has no vertices with properties x, y and z")


def _from_bytes(source: Source, header: Header, chosen: Element) -> tuple[_Table, int]:
    """Return the scalar properties of a binary element, and the number of bytes that are left.

    The other elements are checked to be whole.
    """
    assert header.order is not None
    source.stream.seek(header.size)
    data = source.read(source.size)
    start = 0
    table: _Table = {}
    for element in header.elements:
        if element.has_lists:
            rows, start = list_rows(data, start, element, header.order, element is chosen)
        else:
            kind = element.dtype(header.order)
            end = start + element.count * kind.itemsize
            if end > len(data):
                raise _ends_early(element, max(0, len(data) - start) // kind.itemsize)
            rows = data[start:end].view(kind)
            start = end
        if element is chosen:
            table = {name: rows[name] for name in element.scalars}
    return table, len(data) - start


def _from_text(source: Source, header: Header, chosen: Element) -> _Table:
    """Return the scalar properties of an element in ASCII; check that the others are there."""

    def lines() -> Any:
        text = lines_of(source, header.size)
        return (line.lstrip("\ufeff") for line in text if line.strip("\ufeff \t\r\n"))

    before = 0
    table: _Table = {}
    for element in header.elements:
        if element is chosen and not element.has_lists:
            width = len(element.properties)
            used = partial(load_rows, lines, range(width), width=width, exact=False)
            rows = used(skip=before, limit=element.count)
            if len(rows) < element.count:
                raise _ends_early(element, len(rows))
            table = {
                item.name: as_declared(rows[:, i], np.dtype(item.kind))
                for i, item in enumerate(element.properties)
            }
        elif element is chosen:
            table = _ragged(list(islice(lines(), before, before + element.count)), element)
        before += element.count
    _check_end(lines(), header)
    return table


def _ragged(lines: list[str], element: Element) -> _Table:
    """Return the scalars of rows that have lists too."""
    if len(lines) < element.count:
        raise _ends_early(element, len(lines))
    values: dict[str, list[float]] = {name: [] for name in element.scalars}
    for line in lines:
        words = iter(line.split())
        try:
            for item in element.properties:
                if item.length is None:
                    values[item.name].append(float(next(words)))
                else:
                    length = int(next(words))
                    if len(list(islice(words, length))) < length:
                        raise StopIteration
        except (StopIteration, ValueError):
            raise InputError(
                f"a {element.name} does not fit its properties; is it damaged? ({line[:40]!r})"
            ) from None
    kinds = {item.name: np.dtype(item.kind) for item in element.properties}
    return {name: as_declared(np.array(column), kinds[name]) for name, column in values.items()}


def _check_end(lines: Any, header: Header) -> None:
    """Raise ``InputError`` if the last row of a text is missing or cut."""
    last = next((item for item in reversed(header.elements) if item.count), None)
    if last is None:
        return
    wanted = sum(element.count for element in header.elements)
    row, number = "", 0
    for number, row in enumerate(islice(lines, wanted), start=1):  # noqa: B007
        pass
    if number < wanted:
        raise _ends_early(last, max(0, last.count - (wanted - number)))
    if last.has_lists:
        _ragged([row], Element(last.name, 1, last.properties))


def _ends_early(element: Element, rows: int) -> InputError:
    return InputError(
        f"ends after {rows} of its {element.count} rows of element {element.name};"
        " is it damaged, or truncated?"
    )
