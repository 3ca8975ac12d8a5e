"""The header of an E57 file, which libE57 reads: its scans, their fields and boxes.

libE57 is used without pye57's class ``E57``, which removes a file that it cannot open.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError, install_hint

from .e57_poses import moved
from .source import Source, unpacked_limit

__all__ = ["E57Header", "field_names", "opened_e57", "read_e57_header"]

HEADER = struct.Struct("<8sIIQQQQ")
"""Signature, version, length of the file, place and length of the XML, length of a page."""

PAGE = 1024
CHECKSUM = 4
"""Bytes at the end of a page that check it."""

LEAST = 12
"""Bytes of a point as three floats, by which a count is checked."""


class E57Header(NamedTuple):
    """Header of the file, before the points.

    Parameters
    ----------
    scans
        Number of scans.
    points
        Their points, those that are marked as invalid too.
    fields
        The fields of all scans, and the type of each in numpy's words.
    corners
        Corners of the boxes in which the scans lie, each moved by its pose: shape (n, 8, 3). None
        if a scan does not tell its box.
    system
        The coordinate system as well-known text; empty if there is none.
    """

    scans: int
    points: int
    fields: dict[str, str]
    corners: npt.NDArray[np.float64] | None
    system: str


def read_e57_header(source: Source) -> E57Header:
    """Return what a file says of its points.

    Raises
    ------
    InputError
        As ``read_e57``.
    """
    with opened_e57(source) as (libe57, image, scans, total):
        fields: dict[str, str] = {}
        for scan in scans:
            prototype = libe57.StructureNode(scan["points"].prototype())
            for name in field_names(libe57, scan["points"]):
                fields.setdefault(name, _type_of(prototype[name], libe57))
        boxes = [_box(scan) for scan in scans]
        known = [box for box in boxes if box is not None]
        root = image.root()
        name = "coordinateMetadata"
        system = str(root[name].value()) if root.isDefined(name) else ""
        corners = np.stack(known) if len(known) == len(boxes) else None
        return E57Header(len(scans), total, fields, corners, system)


def _type_of(node: Any, libe57: Any) -> str:
    """Return the type of a field; scaled integers are numbers with a fraction."""
    kind = type(node).__name__
    if kind == "FloatNode":
        return "float32" if node.precision() == libe57.E57_SINGLE else "float64"
    return "integer" if kind == "IntegerNode" else "scaled integer"


def _box(scan: Any) -> npt.NDArray[np.float64] | None:
    """Return the corners of a scan's box, moved by its pose: shape (8, 3); None without a box."""
    if not scan.isDefined("cartesianBounds"):
        return None
    bounds = scan["cartesianBounds"]
    names = [f"{axis}{end}" for end in ("Minimum", "Maximum") for axis in "xyz"]
    if not all(bounds.isDefined(name) for name in names):
        return None
    ends = np.array([float(bounds[name].value()) for name in names]).reshape(2, 3)
    if not np.isfinite(ends).all() or not (ends[0] <= ends[1]).all():
        return None
    which = np.array(list(np.ndindex(2, 2, 2)))
    return moved(scan, np.take_along_axis(ends, which, axis=0))


@contextmanager
def opened_e57(source: Source) -> Iterator[tuple[Any, Any, list[Any], int]]:
    """Open a file with libE57; yield it, the image, its scans with points, and their points.

    Raises
    ------
    InputError
        If pye57 is missing, or the header is damaged or promises no points, or too many.
    """
    xml = _checked_xml(source)
    if b"<!" in xml.replace(b"<![CDATA[", b"").replace(b"<!--", b""):
        raise InputError("cannot be read as E57: its XML has declarations of its own")
    try:
        from pye57 import libe57
    except ModuleNotFoundError:
        raise InputError(f"E57 needs pye57: {install_hint('e57')}") from None
    image = libe57.ImageFile(f"/dev/fd/{source.stream.fileno()}", "r")
    try:
        scans = [scan for scan in _children(image.root()["data3D"]) if scan.isDefined("points")]
        total = sum(scan["points"].childCount() for scan in scans)
        if total > unpacked_limit(source.size) // LEAST:
            raise InputError(
                f"promises {total:,} points, more than {source.size:,} bytes hold; is it damaged?"
            )
        if not total:
            raise InputError("has no points")
        yield libe57, image, scans, total
    finally:
        image.close()


def _checked_xml(source: Source) -> bytes:
    """Return the XML that describes the file; raise if it is not inside the file."""
    source.stream.seek(0)
    head = source.stream.read(HEADER.size)
    if len(head) < HEADER.size or head[:8] != b"ASTM-E57":
        raise InputError("cannot be read as E57: it does not begin with ASTM-E57")
    _, _, _, length, at, size, page = HEADER.unpack(head)
    if page != PAGE or length > source.size or not HEADER.size <= at < length or size > length - at:
        raise InputError("its header does not fit the file's size; is it damaged, or truncated?")
    start = at % PAGE
    source.stream.seek(at - start)
    pages = source.stream.read(length - at + start)
    logical = b"".join(
        pages[first : first + PAGE - CHECKSUM] for first in range(0, len(pages), PAGE)
    )
    return logical[start : start + size]


def _children(node: Any) -> list[Any]:
    """Return the children of a vector or structure."""
    return [node[i] for i in range(node.childCount())]


def field_names(libe57: Any, points: Any) -> tuple[str, ...]:
    """Return the fields of a scan's points."""
    prototype = libe57.StructureNode(points.prototype())
    return tuple(prototype.get(i).elementName() for i in range(prototype.childCount()))
