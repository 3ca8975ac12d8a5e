"""PCD files: ASCII, binary and compressed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .assemble import Columns
from .columns import find_fields, stack

__all__ = ["read_pcd"]


def read_pcd(path: Path) -> Columns:
    """Return the points of a PCD file.

    A packed colour, the field ``rgb`` or ``rgba``, is unpacked. Otherwise colours come from three
    fields, as in the other formats.

    Raises
    ------
    InputError
        If it has no x, y and z, or ends early.
    Exception
        Of many types, from pypcd4, if the file is damaged.
    """
    from pypcd4 import PointCloud

    cloud = PointCloud.from_path(path)
    rows = np.atleast_1d(cloud.pc_data)  # one ASCII point comes without an axis
    if len(rows) != cloud.points:
        raise InputError(f"ends after {len(rows)} of its {cloud.points} points; it is truncated")
    names = list(rows.dtype.names or ())
    fields = find_fields(names)
    if fields is None:
        raise InputError("has no fields x, y and z")
    packed = next((name for name in names if name.lower() in ("rgb", "rgba")), None)
    colours = None
    if packed is not None:
        colours = _unpack(rows[packed])
    elif fields.colours:
        colours = stack(rows, fields.colours)
    return Columns(
        stack(rows, fields.positions),
        stack(rows, fields.normals) if fields.normals else None,
        colours,
    )


def _unpack(packed: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return red, green and blue of packed colours: 0xRRGGBB as integers or in floats' bits."""
    packed = np.ascontiguousarray(packed)
    if packed.dtype == np.float32:
        bits = packed.view(np.uint32)
    elif packed.dtype.kind in "iu":
        bits = packed.astype(np.uint32)
    else:
        raise InputError("packs its colours in 64-bit floats; use 32 bits")
    return np.stack([bits >> 16 & 255, bits >> 8 & 255, bits & 255], axis=-1).astype(np.uint8)
