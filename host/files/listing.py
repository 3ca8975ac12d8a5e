"""Contents of a cloud file by its header, without its points: a listing for every format."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .columns import find_meaning
from .copc import COPC
from .e57_header import read_e57_header
from .las_facts import las_extent, las_facts, named_system
from .las_fields import Fields, field_names
from .las_header import read_las_header
from .pcd_header import read_header as read_pcd_header
from .ply_header import read_header as read_ply_header
from .read_npz import array_shapes, npy_shape, values_a_row
from .read_ply import points_of
from .read_ptx import read_ptx_header
from .read_text import read_layout
from .source import Source

__all__ = ["HEADERS", "Listing", "taken_for"]

Extent = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Listing:
    """Header of the file, before the points.

    Parameters
    ----------
    form
        The format and its variant.
    points
        Number of points, or None if the header does not say.
    types
        Type of each column by its name, such as ``uint8`` or ``3 x float32``.
    widths
        Values of a column in one row, if it is not 1; 0 if they are no numbers.
    named
        Whether the file names its columns. Else their number and their values tell their meaning.
    extent
        Lowest and highest coordinates, if the header has them.
    facts
        What else it says, by a name in words.
    """

    form: str
    points: int | None
    types: dict[str, str]
    widths: dict[str, int] = field(default_factory=dict)
    named: bool = True
    extent: Extent | None = None
    facts: dict[str, str] = field(default_factory=dict)


def taken_for(listing: Listing) -> tuple[dict[str, str], tuple[str, ...]]:
    """Return what columns are taken for, by their names, and the names of the ignored ones.

    Both are empty if the values must tell.
    """
    if not listing.named:
        return {}, ()
    meaning = find_meaning(list(listing.types), listing.widths)
    if meaning is None:
        return {}, tuple(listing.types)
    used = dict.fromkeys(meaning.positions, "position")
    used |= dict.fromkeys(meaning.normals, "normal")
    used |= dict.fromkeys(meaning.colours, meaning.kind)
    return used, meaning.ignored


def _ply(source: Source) -> Listing:
    header = read_ply_header(source)
    points = points_of(header)
    orders = {None: "text", "<": "binary, little endian", ">": "binary, big endian"}
    types = {
        item.name: np.dtype(item.kind).name + ("" if item.length is None else ", a list")
        for item in points.properties
    }
    widths = {item.name: 0 for item in points.properties if item.length is not None}
    others = [f"{item.count:,} {item.name}" for item in header.elements if item is not points]
    facts = {"other elements": ", ".join(others)} if others else {}
    return Listing(f"PLY, {orders[header.order]}", points.count, types, widths, facts=facts)


def _pcd(source: Source) -> Listing:
    header = read_pcd_header(source)
    fields = [item for item in header.fields if item.name.split()[0] != "_"]
    types = {item.name: _type(item.kind, item.count) for item in fields}
    widths = {item.name: item.count for item in fields}
    return Listing(f"PCD, {header.form.replace('_', ', ')}", header.points, types, widths)


def _npz(source: Source) -> Listing:
    with zipfile.ZipFile(source.stream) as archive:
        shapes = array_shapes(archive, source.size)
        widths = {name: values_a_row(name, *shape) for name, shape in shapes.items()}
    types = {
        name: f"{kind.name}, shape {' x '.join(f'{side:,}' for side in shape) or 'none'}"
        for name, (shape, kind) in shapes.items()
    }
    meaning = find_meaning(list(shapes), widths)
    points = None if meaning is None else shapes[meaning.positions[0]][0][0]
    return Listing("NPZ", points, types, widths)


def _npy(source: Source) -> Listing:
    shape, kind, parts = npy_shape(source)
    if kind.names is None:
        types = {f"column {i + 1}": kind.name for i in range(shape[1])}
        return Listing("NPY", shape[0], types, named=False)
    types = {name: _type(kind[name].base, parts.get(name, 1)) for name in kind.names}
    widths = {**dict.fromkeys(kind.names, 0), **parts}
    return Listing("NPY, structured", int(np.prod(shape)), types, widths)


def _text(source: Source) -> Listing:
    encoding, layout = read_layout(source)
    names = layout.names or [f"column {i + 1}" for i in range(layout.columns)]
    types = {name: "words" if name in layout.words else "number" for name in names}
    between = {None: "blanks", "\t": "tabs"}.get(layout.delimiter, f"{layout.delimiter!r}")
    kind = source.suffix[1:].upper()
    return Listing(
        f"{kind}, text in {encoding}, values between {between}",
        layout.promised,
        types,
        dict.fromkeys(layout.words, 0),
        named=layout.names is not None,
    )


def _las(source: Source) -> Listing:
    header = read_las_header(source)
    names = field_names(header)
    table = Fields(header, names).empty(0)
    kind = "LAZ" if header.laszip else "LAS"
    tree = ", COPC" if COPC in header.records else ""
    return Listing(
        f"{kind} 1.{header.minor}, point format {header.form}{tree}",
        header.count,
        {name: table[name].dtype.name for name in names},
        extent=las_extent(header),
        facts=las_facts(header),
    )


def _e57(source: Source) -> Listing:
    header = read_e57_header(source)
    facts = {"scans": f"{header.scans:,}"}
    if system := named_system(header.system):
        facts["coordinate system"] = system
    extent = None
    if header.corners is not None:
        facts["bounds"] = "the boxes of the scans, which may be wider than their points"
        corners = header.corners.reshape(-1, 3)
        extent = _triple(corners.min(axis=0)), _triple(corners.max(axis=0))
    return Listing("E57", header.points, header.fields, extent=extent, facts=facts)


def _triple(row: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = row.tolist()
    return x, y, z


def _ptx(source: Source) -> Listing:
    scans, points, names = read_ptx_header(source)
    return Listing(
        "PTX, text", points, dict.fromkeys(names, "number"), facts={"scans": f"{scans:,}"}
    )


def _type(kind: np.dtype[Any], count: int) -> str:
    return kind.name if count == 1 else f"{count} x {kind.name}"


HEADERS: dict[str, Callable[[Source], Listing]] = {
    ".ply": _ply,
    ".pcd": _pcd,
    **dict.fromkeys((".xyz", ".xyzn", ".xyzrgb", ".txt", ".asc", ".csv", ".pts"), _text),
    ".npz": _npz,
    ".npy": _npy,
    **dict.fromkeys((".las", ".laz"), _las),
    ".e57": _e57,
    ".ptx": _ptx,
}
"""Reader of the header of each format, by the file name's suffix. A format without one is read as a
whole."""
