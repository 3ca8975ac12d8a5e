"""NPZ files: arrays by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from splatline.contract.errors import InputError

from .assemble import Columns

__all__ = ["read_npz"]

POSITIONS = ("positions", "points", "xyz", "vertices", "pos")
NORMALS = ("normals", "normal")
COLOURS = ("colours", "colors", "rgb", "colour", "color")


def read_npz(path: Path) -> Columns:
    """Return the points of an NPZ file.

    Positions are the first array that is named as in ``POSITIONS``, normals as in ``NORMALS``,
    colours as in ``COLOURS``, in any case: shape (n, 3). A fourth column of colours is ignored,
    and so are arrays with other names.

    Raises
    ------
    InputError
        If there are no positions, or an array has another shape or no numbers.
    Exception
        Of several types, from numpy and zipfile, if the file is damaged.
    """
    # Opened here: numpy would leave the file of a damaged archive open.
    with path.open("rb") as stream:
        arrays = np.load(stream, allow_pickle=False)
        if not hasattr(arrays, "files"):
            raise InputError("is one array, not an archive of arrays")
        names = {name.lower(): name for name in reversed(arrays.files)}

        def first_of(kinds: tuple[str, ...], columns: tuple[int, ...] = (3,)) -> Any:
            name = next((names[kind] for kind in kinds if kind in names), None)
            return None if name is None else _checked(name, arrays[name], columns)

        positions = first_of(POSITIONS)
        if positions is None:
            raise InputError(f"has no array named {', '.join(POSITIONS[:-1])} or {POSITIONS[-1]}")
        normals = first_of(NORMALS)
        colours = first_of(COLOURS, (3, 4))
    for kind, array in (("normals", normals), ("colours", colours)):
        if array is not None and len(array) != len(positions):
            raise InputError(f"has {len(positions)} positions but {len(array)} {kind}")
    return Columns(positions, normals, None if colours is None else colours[:, :3])


def _checked(name: str, array: npt.NDArray[Any], columns: tuple[int, ...]) -> npt.NDArray[Any]:
    """Return an array if it has one row of numbers a point."""
    if array.ndim != 2 or array.shape[1] not in columns or array.dtype.kind not in "iuf":
        raise InputError(
            f"its array {name} has shape {array.shape} and type {array.dtype}; "
            "it must have numbers in shape (n, 3)"
        )
    return array
