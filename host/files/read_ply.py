"""PLY files: ASCII and binary, either endianness."""

from __future__ import annotations

from pathlib import Path

from splatline.contract.errors import InputError

from .assemble import Columns
from .columns import find_fields, stack

__all__ = ["read_ply"]

# Lists of a known length are mapped into memory instead of read face by face.
_TRIANGLES = {"face": {"vertex_indices": 3, "vertex_index": 3}}


def read_ply(path: Path) -> Columns:
    """Return the points of a PLY file: the element ``vertex``, or else the first with x, y, z.

    Other elements, such as faces, are ignored, but a file that ends inside them is refused.

    Raises
    ------
    InputError
        If there is no such element.
    plyfile.PlyParseError, ValueError
        If the file is damaged.
    """
    from plyfile import PlyData, PlyElementParseError

    try:
        data = PlyData.read(str(path), known_list_len=_TRIANGLES)
    except PlyElementParseError as error:
        if error.message != "unexpected list length":
            raise
        data = PlyData.read(str(path))  # faces of other shapes
    for element in sorted(data.elements, key=lambda element: element.name != "vertex"):
        # A list property has no single value for each point.
        rows = element.data
        names = [name for name in rows.dtype.names or () if rows.dtype[name].kind in "iuf"]
        fields = find_fields(names)
        if fields is not None:
            break
    else:
        raise InputError("has no vertices with properties x, y and z")
    return Columns(
        stack(rows, fields.positions),
        stack(rows, fields.normals) if fields.normals else None,
        stack(rows, fields.colours) if fields.colours else None,
    )
