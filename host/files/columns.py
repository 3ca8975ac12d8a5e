"""The meaning of a cloud file's columns, by their names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["Fields", "find_fields", "stack"]

Names = tuple[str, str, str]

POSITIONS: tuple[Names, ...] = (("x", "y", "z"),)
NORMALS: tuple[Names, ...] = (
    ("nx", "ny", "nz"),
    ("normal_x", "normal_y", "normal_z"),
    ("normalx", "normaly", "normalz"),
)
COLOURS: tuple[Names, ...] = (
    ("red", "green", "blue"),
    ("r", "g", "b"),
    ("diffuse_red", "diffuse_green", "diffuse_blue"),
)


@dataclass(frozen=True)
class Fields:
    """Names of the columns that hold positions, normals and colours, as the file spells them."""

    positions: Names
    normals: Names | None
    colours: Names | None

    @property
    def groups(self) -> tuple[Names, ...]:
        """The groups that the file has."""
        return tuple(
            group for group in (self.positions, self.normals, self.colours) if group is not None
        )


def find_fields(names: Sequence[str]) -> Fields | None:
    """Return the columns of positions, normals and colours, or None without x, y and z.

    Case does not matter. Other columns are ignored.
    """
    spelled = {name.strip().lower(): name for name in reversed(names)}

    def first_of(kinds: tuple[Names, ...]) -> Names | None:
        for a, b, c in kinds:
            if a in spelled and b in spelled and c in spelled:
                return spelled[a], spelled[b], spelled[c]
        return None

    positions = first_of(POSITIONS)
    if positions is None:
        return None
    return Fields(positions, first_of(NORMALS), first_of(COLOURS))


def stack(columns: Mapping[str, Any] | Any, names: Names) -> npt.NDArray[Any]:
    """Return three columns side by side, in the machine's own byte order: shape (n, 3)."""
    return np.stack([np.asarray(columns[name]) for name in names], axis=-1)
