"""Which points of a LAS file are drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .las_fields import Fields
from .las_header import LasHeader

__all__ = ["Drawn"]

NOISE = (7, 18)
"""Classes of low and of high noise."""

FLAGS_SINCE = 1
"""Minor version in which a class got its flags. Before, it means what the maker of a file says."""

LONG_CLASS = 6
"""First point format with a class of 8 bits; class 18 is no noise in those before."""


class Drawn:
    """Leaves out points that are withheld or noise; see ``read_las``.

    Parameters
    ----------
    header
        The file's header.
    fields
        The fields that are wanted.

    Attributes
    ----------
    read
        The fields that must be read for that.
    """

    def __init__(self, header: LasHeader, fields: Fields) -> None:
        self._flags = None
        self._noise = NOISE[: 1 + (header.form >= LONG_CLASS)]
        self.read = fields
        if header.minor >= FLAGS_SINCE:
            self._flags = Fields(header, ("withheld", "classification"))
            self.read = Fields(header, (*fields.names, *self._flags.names))

    def split(self, rows: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], dict[str, int]]:
        """Return those of some points that are drawn, and the number of the others, by reason."""
        dropped: dict[str, int] = {}
        if self._flags is None:
            return rows, dropped
        table = self._flags.table(rows)
        withheld = table["withheld"] != 0
        noise = np.isin(table["classification"], self._noise)
        noise &= ~withheld
        for reason, which in (("withheld", withheld), ("noise", noise)):
            if found := int(np.count_nonzero(which)):
                dropped[reason] = found
        return (rows[~(withheld | noise)] if dropped else rows), dropped
